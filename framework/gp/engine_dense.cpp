// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

namespace palpate {
namespace {

/// Largest number of reserved values, 1 GiB. Reserved memory costs nothing until it is used.
constexpr double kMostReserved = 1.0 * (1 << 27);

/// Number of blocks per call of the kernel. A call has an overhead that equals the time of about ten candidates.
constexpr int kBlocksPerCall = 4;
constexpr Eigen::Index kCandidatesPerCall = Eigen::Index{kBlocksPerCall} * loops::kBlock;

class DenseEngine final : public Engine {
 public:
  DenseEngine(const std::shared_ptr<Workers>& workers, const Kernel& kernel, const CandidateGrid& candidates)
      : Engine("dense", workers, kernel, candidates, Tiling::blocks(candidates.size())),
        rows_(maps_.tiling().strips() * loops::kBlock, loops::kBlock, loops::kBlock) {
    for (int i = 0; i < workers->threads(); ++i) covariances_.emplace_back(kCandidatesPerCall);
  }

  void reserve(int rows) override {
    if (static_cast<double>(rows) * candidates_.size() <= kMostReserved) rows_.reserve(rows);
  }
  bool needs_inverse() const override { return false; }

  void absorb(const FactorRow& row) override {
    const int depth = rows_.rows();
    rows_.extend();
    const int blocks = maps_.tiling().strips();
    workers_->for_each((blocks + kBlocksPerCall - 1) / kBlocksPerCall, [&](int group, int worker) {
      double* covariance = covariances_[static_cast<std::size_t>(worker)].data();
      const int block = group * kBlocksPerCall;
      const Eigen::Index first = group * kCandidatesPerCall;
      const Eigen::Index count = std::min<Eigen::Index>(kCandidatesPerCall, candidates_.size() - first);
      kernel_.covariance(candidates_.points.middleRows(first, count), row.positions.bottomRows(1),
                         Eigen::Map<Eigen::VectorXd>(covariance, count));
      const Eigen::Index padded = (count + loops::kBlock - 1) / loops::kBlock * loops::kBlock;
      std::fill(covariance + count, covariance + padded, 0.0);
      for (int i = 0; i < padded / loops::kBlock; ++i, covariance += loops::kBlock)
        loops::absorb_dense({rows_.panel(block + i), covariance, row.factor.data(), depth, row.pivot},
                            maps_.update(block + i, row.coefficients));
    });
  }

 private:
  void clear() override { rows_.clear(); }

  loops::Panels rows_;  ///< V, one panel per block of candidates
  /// scratch per worker: covariances of some candidates with the last tap
  std::vector<loops::AlignedArray> covariances_;
};

}  // namespace

std::unique_ptr<Engine> make_dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                   const CandidateGrid& candidates) {
  return std::make_unique<DenseEngine>(workers, kernel, candidates);
}

}  // namespace palpate
