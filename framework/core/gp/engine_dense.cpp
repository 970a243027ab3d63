// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

namespace palpate {
namespace {

/// Rows are reserved up to so many numbers (1 GiB), of which only those that are used are paid for.
constexpr double kMostReserved = 1.0 * (1 << 27);

class Dense final : public Engine {
 public:
  Dense(const Machine& machine, const Kernel& kernel, const Candidates& candidates)
      : Engine("dense", machine, kernel, candidates, Tiling::pieces(candidates.size())),
        rows_(maps_.tiling().strips() * simd::kPiece, simd::kPiece, simd::kPiece) {}

  void reserve(int rows) override {
    if (static_cast<double>(rows) * candidates_.size() <= kMostReserved) rows_.reserve(rows);
  }
  bool needs_inverse() const override { return false; }

  void absorb(const FactorRow& row) override {
    const int depth = rows_.rows();
    rows_.extend();
    machine_.workers->for_each(maps_.tiling().strips(), [&](int piece, int) {
      const Eigen::Index first = static_cast<Eigen::Index>(piece) * simd::kPiece;
      const Eigen::Index count = std::min<Eigen::Index>(simd::kPiece, candidates_.size() - first);
      Eigen::Map<Eigen::VectorXd> own(rows_.row(piece, depth), simd::kPiece);
      kernel_.covariance(candidates_.points.middleRows(first, count), row.places.bottomRows(1), own.head(count));
      own.tail(simd::kPiece - count).setZero();
      machine_.loops->absorb_dense({rows_.panel(piece), row.factor.data(), depth, row.pivot},
                                   maps_.update(piece, row.coefficients));
    });
  }

 private:
  void clear() override { rows_.clear(); }

  simd::Panels rows_;  ///< V, a piece of the candidates a panel
};

}  // namespace

std::unique_ptr<Engine> make_dense(const Machine& machine, const Kernel& kernel, const Candidates& candidates) {
  return std::make_unique<Dense>(machine, kernel, candidates);
}

}  // namespace palpate
