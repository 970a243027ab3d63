// SPDX-License-Identifier: MIT
// Scores of the candidates, in pieces of which the best is known before it is looked for.
#pragma once

#include "gp/maps.hpp"

#include <algorithm>

namespace palpate {

struct ScoredCell {
  int candidate;
  double score;
};

/// The scores of all candidates. Whoever looks for the best need only read the pieces whose bound comes near to it.
class Scores {
 public:
  virtual ~Scores() = default;
  virtual int pieces() const = 0;
  /// No score of the piece is above this; infinite where that is not known.
  virtual double bound(int piece) const = 0;
  /// The candidates of a piece, at most kMostCells; returns how many. Of the pieces in their order, and within a piece,
  /// candidates may come in any order.
  virtual int read(int piece, ScoredCell* out) const = 0;
};

/// Scores that lie in memory, one a candidate.
class VectorScores final : public Scores {
 public:
  /// `scores` must outlive it.
  explicit VectorScores(const Eigen::VectorXd& scores) : scores_(scores) {}
  int pieces() const override { return static_cast<int>((scores_.size() + kMostCells - 1) / kMostCells); }
  double bound(int piece) const override { return scores_.segment(first(piece), count(piece)).maxCoeff(); }
  int read(int piece, ScoredCell* out) const override {
    for (int i = 0; i < count(piece); ++i) out[i] = {first(piece) + i, scores_(first(piece) + i)};
    return count(piece);
  }

 private:
  static int first(int piece) { return piece * kMostCells; }
  int count(int piece) const { return std::min(kMostCells, static_cast<int>(scores_.size()) - first(piece)); }

  const Eigen::VectorXd& scores_;
};

}  // namespace palpate
