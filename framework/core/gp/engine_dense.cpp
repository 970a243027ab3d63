// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

namespace palpate {
namespace {

/// Rows are reserved up to so many numbers (1 GiB), of which only those that are used are paid for.
constexpr double kMostReserved = 1.0 * (1 << 27);

/// Pieces for which the kernel is asked at once: a call costs what ten candidates do.
constexpr int kTogether = 4;
constexpr Eigen::Index kCandidates = Eigen::Index{kTogether} * loops::kBlock;

class Dense final : public Engine {
 public:
  Dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel, const Candidates& candidates)
      : Engine("dense", workers, kernel, candidates, Tiling::blocks(candidates.size())),
        rows_(maps_.tiling().strips() * loops::kBlock, loops::kBlock, loops::kBlock) {
    for (int i = 0; i < workers->threads(); ++i) covariances_.emplace_back(kCandidates);
  }

  void reserve(int rows) override {
    if (static_cast<double>(rows) * candidates_.size() <= kMostReserved) rows_.reserve(rows);
  }
  bool needs_inverse() const override { return false; }

  void absorb(const FactorRow& row) override {
    const int depth = rows_.rows();
    rows_.extend();
    const int pieces = maps_.tiling().strips();
    workers_->for_each((pieces + kTogether - 1) / kTogether, [&](int group, int worker) {
      double* covariance = covariances_[static_cast<std::size_t>(worker)].data();
      const int piece = group * kTogether;
      const Eigen::Index first = group * kCandidates;
      const Eigen::Index count = std::min<Eigen::Index>(kCandidates, candidates_.size() - first);
      kernel_.covariance(candidates_.points.middleRows(first, count), row.places.bottomRows(1),
                         Eigen::Map<Eigen::VectorXd>(covariance, count));
      const Eigen::Index padded = (count + loops::kBlock - 1) / loops::kBlock * loops::kBlock;
      std::fill(covariance + count, covariance + padded, 0.0);
      for (int i = 0; i < padded / loops::kBlock; ++i, covariance += loops::kBlock) {
        loops::absorb_dense({rows_.panel(piece + i), covariance, row.factor.data(), depth, row.pivot},
                            maps_.update(piece + i, row.coefficients));
      }
    });
  }

 private:
  void clear() override { rows_.clear(); }

  loops::Panels rows_;                     ///< V, a piece of the candidates a panel
  std::vector<loops::Lines> covariances_;  ///< of a group of pieces with the last tap, one a worker
};

}  // namespace

std::unique_ptr<Engine> make_dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                   const Candidates& candidates) {
  return std::make_unique<Dense>(workers, kernel, candidates);
}

}  // namespace palpate
