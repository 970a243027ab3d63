// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"
#include "gp/engine.hpp"

#include <cstring>
#include <limits>

namespace palpate {
namespace {

using loops::kLine;
constexpr int kRows = loops::kStripRows;
constexpr std::ptrdiff_t kTile = std::ptrdiff_t{kRows} * loops::kPanelLines * kLine;  ///< numbers in a full tile

/// One axis of the grid: the basis of its covariance matrix, and the newest tap in coordinates of this basis.
struct BasisAxis {
  const Eigen::VectorXd& positions;
  AxisBasis basis;
  /// covariances of the newest tap with `positions`; take() keeps only the part outside the span of the basis
  Eigen::VectorXd covariance;
  Eigen::VectorXd coordinates;  ///< coordinates of the covariance in the basis
  double largest = 0.0;         ///< largest absolute covariance of the newest tap
  double residual = 0.0;        ///< largest absolute value of the part outside the span of the basis

  BasisAxis(const Kernel& kernel, int axis, const Eigen::VectorXd& along, double tolerance)
      : positions(along),
        basis(axis_basis(kernel, axis, along, tolerance)),
        covariance(along.size()),
        coordinates(basis.rank()) {}

  void take(const Kernel& kernel, int axis, const FactorRow& row) {
    kernel.axis_covariance(axis, positions, row.positions.bottomRows(1).col(axis), covariance);
    largest = covariance.cwiseAbs().maxCoeff();
    coordinates.noalias() = basis.directions.transpose() * covariance;
    covariance.noalias() -= basis.directions * coordinates;
    residual = covariance.cwiseAbs().maxCoeff();
  }
};

/// Computes v = U_y S U_x^T with S = P_y^T diag(c) P_x; see engine.hpp. The product with U_x^T takes most of the time.
class LowrankEngine final : public Engine {
 public:
  LowrankEngine(const std::shared_ptr<Workers>& workers, const Kernel& kernel, const CandidateGrid& candidates,
                BasisAxis x, BasisAxis y)
      : Engine("lowrank", workers, kernel, candidates,
               x.basis.mirrored ? Tiling::mirrored_grid(candidates) : Tiling::grid(candidates)),
        x_(std::move(x)),
        y_(std::move(y)),
        in_x_(x_.basis.rank(), loops::kPanelLines * kLine, kLine),
        in_y_(y_.basis.rank(), kRows, kRows),
        // Contains only the left half of the grid if the basis is symmetric.
        basis_x_(x_.basis.mirrored ? (candidates.columns + 1) / 2 : candidates.columns, loops::kPanelLines * kLine,
                 kLine),
        basis_y_(candidates.rows, loops::kPanelLines * kLine, kLine),
        shares_(static_cast<std::size_t>(in_x_.padded()) * static_cast<std::size_t>(in_y_.padded())),
        shares_by_x_(shares_.size()),
        rows_(static_cast<std::size_t>(in_x_.padded()) * static_cast<std::size_t>(basis_y_.padded())) {
    basis_x_.reserve(x_.basis.rank());
    basis_y_.reserve(y_.basis.rank());
    for (int i = 0; i < x_.basis.rank(); ++i) basis_x_.append(x_.basis.directions.col(i).data());
    for (int i = 0; i < y_.basis.rank(); ++i) basis_y_.append(y_.basis.directions.col(i).data());
    for (int i = 0; i < workers->threads(); ++i) a_.emplace_back(static_cast<std::size_t>(x_.basis.rank()) * kRows);
  }

  void reserve(int rows) override {
    reserved_ = rows;
    in_x_.reserve(rows);
    in_y_.reserve(rows);
    if (errors_.size() < rows) errors_.conservativeResize(rows);
  }
  bool needs_inverse() const override { return true; }

  void absorb(const FactorRow& row) override {
    x_.take(kernel_, 0, row);
    y_.take(kernel_, 1, row);
    in_x_.append(x_.coordinates.data());
    in_y_.append(y_.coordinates.data());
    store_error();
    form_shares(row.inverse);
    form_rows();
    const int lines = basis_x_.padded() / kLine;
    const std::ptrdiff_t mirror = maps_.tiling().mirror();
    workers_->for_each(maps_.tiling().strips(), [&](int strip, int worker) {
      double* const a = a_[static_cast<std::size_t>(worker)].data();
      gather(strip, a);
      const loops::StripProduct product{a, 0, 1, basis_x_.panel(0), basis_x_.stride(), basis_x_.rows(), lines};
      const loops::Update update = maps_.update(strip, row.coefficients);
      if (mirror > 0) {
        loops::absorb_mirrored({product, x_.basis.even, mirror}, update);
      } else {
        loops::absorb_product(product, update);
      }
    });
  }

  VectorView covariance_errors() const override { return errors_.head(in_x_.rows()); }

 private:
  void clear() override {
    in_x_.clear();
    in_y_.clear();
  }

  /// Stores the covariance error of the newest tap.
  void store_error() {
    // An error of 8 ulp is subtracted, because the kernel may have this error with any engine (kernel.hpp).
    constexpr double kKernelError = 8.0 * std::numeric_limits<double>::epsilon();
    const double residual = x_.residual * y_.largest + x_.largest * y_.residual + x_.residual * y_.residual;
    const double error = std::max(0.0, residual - kKernelError * x_.largest * y_.largest);
    if (errors_.size() < in_x_.rows()) errors_.conservativeResize(Eigen::Index{2} * in_x_.rows());
    errors_(in_x_.rows() - 1) = error;
  }

  /// Computes S = P_y^T diag(c) P_x in strips of rows, and stores S^T in strips of its rows, too.
  void form_shares(const VectorView& inverse) {
    const int depth = in_x_.rows();
    const auto needed = static_cast<std::size_t>(depth) * kRows;
    if (scaled_.size() < needed)
      scaled_ = loops::AlignedArray(std::max(2 * needed, static_cast<std::size_t>(reserved_) * kRows));
    const int lines = in_x_.padded() / kLine;
    double* c = shares_.data();
    for (int strip = 0; strip < in_y_.panels(); ++strip) {
      const double* const from = in_y_.panel(strip);
      double* const scaled = scaled_.data();
      for (std::ptrdiff_t i = 0; i < depth; ++i) {
        for (std::ptrdiff_t m = 0; m < kRows; ++m) scaled[i * kRows + m] = from[i * kRows + m] * inverse(i);
      }
      loops::multiply({scaled_.data(), 0, 1, in_x_.panel(0), in_x_.stride(), depth, lines}, c);
      // Copies the tiles of S, each with 8 rows, to S^T: every 8 numbers in a row of S become a part of a column of
      // S^T.
      for (int line = 0; line < lines; ++line) {
        const int panel = line / loops::kPanelLines;
        const std::ptrdiff_t width = in_x_.width(panel);
        const double* tile = c + panel * kTile + static_cast<std::ptrdiff_t>(line % loops::kPanelLines) * kLine;
        const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(line) * in_y_.padded();
        double* out = shares_by_x_.data() + (column + static_cast<std::ptrdiff_t>(strip) * kRows) * kLine;
        for (std::ptrdiff_t m = 0; m < kRows; ++m) std::copy_n(tile + m * width, kLine, out + m * kLine);
      }
    }
  }

  /// Computes S^T U_y^T: the coefficient of each direction along x for each row of the grid.
  void form_rows() {
    loops::multiply({shares_by_x_.data(), static_cast<std::size_t>(in_y_.padded()) * kRows, in_x_.padded() / kRows,
                     basis_y_.panel(0), basis_y_.stride(), basis_y_.rows(), basis_y_.padded() / kLine},
                    rows_.data());
  }

  /// Copies the coefficients that form_rows() computed for the grid rows of a strip, direction by direction.
  void gather(int strip, double* out) const {
    const int row = strip * kRows;
    const int panel = row / (loops::kPanelLines * kLine);
    const std::ptrdiff_t width = basis_y_.width(panel);
    const std::ptrdiff_t within = row % (loops::kPanelLines * kLine);
    const double* tile = rows_.data() + panel * kTile + within;
    const std::ptrdiff_t strip_size = static_cast<std::ptrdiff_t>(basis_y_.padded()) * kRows;
    for (std::ptrdiff_t first = 0; first < basis_x_.rows(); first += kRows, tile += strip_size) {
      const std::ptrdiff_t count = std::min<std::ptrdiff_t>(kRows, basis_x_.rows() - first);
      for (std::ptrdiff_t k = 0; k < count; ++k, out += kRows) std::memcpy(out, tile + k * width, kRows * sizeof *out);
    }
  }

  BasisAxis x_;
  BasisAxis y_;
  Eigen::VectorXd errors_;  ///< errors of covariances: one per tap, then reserved memory
  int reserved_ = 0;
  loops::Panels in_x_;                  ///< P_x, one row per tap
  loops::Panels in_y_;                  ///< P_y
  loops::Panels basis_x_;               ///< U_x^T
  loops::Panels basis_y_;               ///< U_y^T
  loops::AlignedArray scaled_;          ///< scratch: eight columns of P_y times c
  loops::AlignedArray shares_;          ///< S
  loops::AlignedArray shares_by_x_;     ///< S^T
  loops::AlignedArray rows_;            ///< S^T U_y^T
  std::vector<loops::AlignedArray> a_;  ///< scratch per worker
};

}  // namespace

std::unique_ptr<Engine> make_lowrank(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                     const CandidateGrid& candidates, double tolerance) {
  return std::make_unique<LowrankEngine>(workers, kernel, candidates, BasisAxis(kernel, 0, candidates.xs, tolerance),
                                         BasisAxis(kernel, 1, candidates.ys, tolerance));
}

}  // namespace palpate
