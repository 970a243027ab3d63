// SPDX-License-Identifier: MIT
#include "experiment/policy.hpp"

#include "gp/loops.hpp"

#include <boost/random/sobol.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace palpate {
namespace {

std::vector<int> draw_random(int count, int candidates, Random& random) {
  // The first steps of a Fisher-Yates shuffle.
  std::vector<int> order(static_cast<std::size_t>(candidates));
  std::iota(order.begin(), order.end(), 0);
  for (int i = 0; i < count; ++i) {
    const auto from = static_cast<std::size_t>(i) + random.index(static_cast<std::uint64_t>(candidates - i));
    std::swap(order[static_cast<std::size_t>(i)], order[from]);
  }
  order.resize(static_cast<std::size_t>(count));
  return order;
}

/// Adds the candidate nearest to (x, y) unless the design already has it.
void take(std::vector<int>& design, const CandidateGrid& candidates, double x, double y, const Area& area) {
  const int index = candidates.nearest(x, y, area);
  if (std::find(design.begin(), design.end(), index) == design.end()) design.push_back(index);
}

std::vector<int> draw_sobol(std::size_t count, const CandidateGrid& candidates, const Area& area, Random& random) {
  // A digital shift (Owen 2003) XORs one random bit pattern per axis with every point. Unlike a shift modulo 1, it
  // keeps the even spread over halves, quarters, ..., and it still depends on the seed.
  const std::array<std::uint64_t, 2> shift{random.bits(), random.bits()};
  boost::random::sobol sequence(2);
  const auto coordinate = [](std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; };
  std::vector<int> design;
  std::array<std::uint64_t, 2> point{0, 0};  // Boost's sequence omits the origin, its first point
  for (std::size_t i = 0; design.size() < count && i < 64 * static_cast<std::size_t>(candidates.size()); ++i) {
    take(design, candidates, coordinate(point[0] ^ shift[0]) * area.width, coordinate(point[1] ^ shift[1]) * area.depth,
         area);
    for (std::uint64_t& axis : point) axis = sequence();
  }
  return design;
}

std::vector<int> draw_lattice(std::size_t count, const CandidateGrid& candidates, const Area& area) {
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<int> design;
  for (int i = 0; i < side * side && design.size() < count; ++i) {
    const int column = i % side;
    const int row = i / side;
    const double x = (column + 0.5) * area.width / side;
    const double y = (row + 0.5) * area.depth / side;
    take(design, candidates, x, y, area);
  }
  return design;
}

/// Visits the allowed candidates for which worth(score, candidate) holds, in no particular order. A block of kBlock
/// candidates is skipped if worth() does not hold for the highest score of the block with the first index of the block.
/// In each group of kBlock blocks, the block with the highest score is first, because its visits may make visits to the
/// other blocks unnecessary.
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
struct Scored {
  int candidate = -1;  ///< -1: none
  double score = -std::numeric_limits<double>::infinity();
  bool before(const Scored& other) const {
    return score > other.score || (score == other.score && candidate < other.candidate);
  }
};

/// Returns the two allowed candidates with the highest scores; of equal scores, the lower index is first.
std::array<Scored, 2> find_best_two(const Eigen::VectorXd& scores, const Allowed& allowed) {
  Scored best, second;
  for_allowed(
      scores, allowed,
      [&](double score, int i) {
        return Scored{i, score}.before(second);
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

std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(options.count);
  Random random(seed, "initial");
  using Design = InitialOptions::Design;
  if (options.design == Design::search) return {};  // chosen one at a time: see SearchDesign
  if (options.design == Design::random) return draw_random(static_cast<int>(count), candidates.size(), random);
  std::vector<int> design = options.design == Design::sobol ? draw_sobol(count, candidates, area, random)
                                                            : draw_lattice(count, candidates, area);
  // If the design has nearly as many points as there are candidates, several points may have the same nearest
  // candidate. The design is then filled with unused candidates, in the order of their indices.
  for (int i = 0; design.size() < count; ++i) {
    if (std::find(design.begin(), design.end(), i) == design.end()) design.push_back(i);
  }
  return design;
}

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
  const Scored& other = out.candidate == best.candidate ? second : best;
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
