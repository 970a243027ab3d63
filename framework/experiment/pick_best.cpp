// SPDX-License-Identifier: MIT
#include "experiment/pick_best.hpp"

#include "gp/vector_loops.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

/// Visits the allowed candidates for which worth(score, candidate) holds, in no particular order. Skips a block of
/// kBlock candidates if worth() does not hold for the block's highest score and first index. In each group of kBlock
/// blocks, the block with the highest score is first, because its visits may make visits to the other blocks
/// unnecessary.
template <class Worth, class Visit>
void for_allowed(const Eigen::VectorXd& scores, const Allowed& allowed, const Worth& worth, const Visit& visit) {
  constexpr Eigen::Index kBlock = loops::kScores;
  const auto look = [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index i = begin; i < end; ++i) {
      if (worth(scores(i), static_cast<int>(i)) && allowed(i)) visit(static_cast<int>(i));
    }
  };
  std::array<double, kBlock> highest;
  const Eigen::Index blocks = scores.size() / kBlock;
  for (Eigen::Index first = 0; first < blocks; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, blocks - first);
    highest.fill(-std::numeric_limits<double>::infinity());
    loops::highest(scores.data() + first * kBlock, static_cast<int>(count), highest.data());
    const auto look_at = [&](Eigen::Index block) {
      const Eigen::Index begin = (first + block) * kBlock;
      if (worth(highest[static_cast<std::size_t>(block)], static_cast<int>(begin))) look(begin, begin + kBlock);
    };
    double most = 0.0;
    loops::highest(highest.data(), 1, &most);
    const Eigen::Index top = std::find(highest.begin(), highest.begin() + count - 1, most) - highest.begin();
    look_at(top);
    for (Eigen::Index i = 0; i < count; ++i) {
      if (i != top) look_at(i);
    }
  }
  look(blocks * kBlock, scores.size());
}

/// A candidate and its score.
struct ScoredCandidate {
  int candidate = -1;  ///< -1: none
  double score = -std::numeric_limits<double>::infinity();
  bool before(const ScoredCandidate& other) const {
    return score > other.score || (score == other.score && candidate < other.candidate);
  }
};

/// Returns the two allowed candidates with the highest scores; of equal scores, the lower index is first.
std::array<ScoredCandidate, 2> find_best_two(const Eigen::VectorXd& scores, const Allowed& allowed) {
  ScoredCandidate best, second;
  for_allowed(
      scores, allowed,
      [&](double score, int i) {
        return ScoredCandidate{i, score}.before(second);
      },
      [&](int i) {
        second = {i, scores(i)};
        if (second.before(best)) std::swap(best, second);
      });
  return {best, second};
}

/// Returns whether is(score) holds for at least one allowed candidate.
template <class Is>
bool any_allowed(const Eigen::VectorXd& scores, const Allowed& allowed, const Is& is) {
  for (Eigen::Index i = 0; i < scores.size(); ++i) {
    if (is(scores(i)) && allowed(i)) return true;
  }
  return false;
}

}  // namespace

Pick pick_best(const Eigen::VectorXd& scores, const Allowed& allowed, double scale, double tolerance) {
  const auto [best, second] = find_best_two(scores, allowed);
  Pick out;
  if (best.candidate < 0) return out;
  out.candidate = best.candidate;
  out.ties = 1;
  const double threshold = best.score - tolerance * (std::abs(best.score) + scale);
  const bool tied = second.candidate >= 0 && second.score >= threshold;
  if (tied) {
    out.ties = 0;
    for_allowed(
        scores, allowed, [&](double score, int) { return score >= threshold; },
        [&](int i) {
          ++out.ties;
          out.candidate = std::min(out.candidate, i);
        });
  }
  // The runner-up is the second best candidate, or the best one if the second best was chosen.
  const ScoredCandidate& other = out.candidate == best.candidate ? second : best;
  out.score = scores(out.candidate);
  out.runner_up = other.candidate;
  if (other.candidate >= 0) out.runner_up_score = other.score;
  if (best.score <= 0.0) {
    out.flat = "no score is positive";
  } else if (tied && !any_allowed(scores, allowed, [&](double one) { return one < threshold; })) {
    out.flat = "every score is equal";
  }
  return out;
}

}  // namespace palpate
