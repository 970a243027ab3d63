// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

namespace palpate {
namespace {

using loops::kLine;

/// Number of strips in a group. All strips of a group use the same covariances along x, which then stay in the cache.
/// Each worker takes a whole group at a time.
constexpr int kGroup = 4;

class GridEngine final : public Engine {
 public:
  GridEngine(const std::shared_ptr<Workers>& workers, const Kernel& kernel, const CandidateGrid& candidates)
      : Engine("grid", workers, kernel, candidates, Tiling::grid(candidates)),
        along_x_(candidates.columns, loops::kPanelLines * kLine, kLine),
        along_y_(candidates.rows, loops::kStripRows, loops::kStripRows),
        column_(std::max(candidates.columns, candidates.rows)),
        scaled_(static_cast<std::size_t>(workers->threads())) {}

  void reserve(int rows) override {
    along_x_.reserve(rows);
    along_y_.reserve(rows);
    for (loops::AlignedArray& one : scaled_) one = loops::AlignedArray(scaled_size(rows));
  }
  bool needs_inverse() const override { return true; }

  void absorb(const FactorRow& row) override {
    append(0, candidates_.xs, row, along_x_);
    append(1, candidates_.ys, row, along_y_);
    const int depth = along_x_.rows();
    if (scaled_.front().size() < scaled_size(depth)) {
      for (loops::AlignedArray& one : scaled_) one = loops::AlignedArray(scaled_size(2 * depth));
    }
    const int strips = maps_.tiling().strips();
    workers_->for_each((strips + kGroup - 1) / kGroup, [&](int group, int worker) {
      const int first = group * kGroup;
      const int count = std::min(kGroup, strips - first);
      double* const a = scaled_[static_cast<std::size_t>(worker)].data();
      const std::size_t a_stride = static_cast<std::size_t>(depth) * loops::kStripRows;
      for (int i = 0; i < count; ++i)
        scale(along_y_.panel(first + i), row.inverse, a + static_cast<std::size_t>(i) * a_stride);
      loops::absorb_product(
          {a, a_stride, count, along_x_.panel(0), along_x_.stride(), depth, along_x_.padded() / kLine},
          maps_.update(first, row.coefficients));
    });
  }

 private:
  void clear() override {
    along_x_.clear();
    along_y_.clear();
  }

  static std::size_t scaled_size(int rows) { return static_cast<std::size_t>(rows) * loops::kStripRows * kGroup; }

  void append(int axis, const Eigen::VectorXd& positions, const FactorRow& row, loops::Panels& to) {
    auto column = column_.head(positions.size());
    kernel_.axis_covariance(axis, positions, row.positions.bottomRows(1).col(axis), column);
    to.append(column.data());
  }

  /// Multiplies the covariances between the strip's rows and each tap by the tap's entry of c (see engine.hpp).
  static void scale(const double* rows, const VectorView& by, double* out) {
    using Rows = Eigen::Array<double, loops::kStripRows, Eigen::Dynamic>;
    const Eigen::Map<const Rows> from(rows, loops::kStripRows, by.size());
    Eigen::Map<Rows>(out, loops::kStripRows, by.size()) = from.rowwise() * by.transpose().array();
  }

  loops::Panels along_x_;  ///< f_x(x_i, X), one row per tap
  loops::Panels along_y_;  ///< f_y(y_i, Y), one row per tap and one panel per strip
  Eigen::VectorXd column_;
  std::vector<loops::AlignedArray> scaled_;  ///< scratch per worker
};

}  // namespace

std::unique_ptr<Engine> make_grid(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                  const CandidateGrid& candidates) {
  return std::make_unique<GridEngine>(workers, kernel, candidates);
}

}  // namespace palpate
