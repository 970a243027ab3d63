// SPDX-License-Identifier: MIT
#include "experiment/policy.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/random/sobol.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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

/// Adds the candidate nearest to (x, y) unless it was taken before.
void take(std::vector<int>& design, const Candidates& candidates, double x, double y, const Area& area) {
  const int index = candidates.nearest(x, y, area);
  if (std::find(design.begin(), design.end(), index) == design.end()) design.push_back(index);
}

std::vector<int> draw_sobol(std::size_t count, const Candidates& candidates, const Area& area, Random& random) {
  // A digital shift (Owen 2003): one random pattern of bits an axis, added without carry to every point. Unlike a
  // shift modulo 1 it keeps the even spread over halves, quarters, ... and still depends on the seed.
  const std::array<std::uint64_t, 2> shift{random.bits(), random.bits()};
  boost::random::sobol sequence(2);
  const auto coordinate = [](std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; };
  std::vector<int> design;
  std::array<std::uint64_t, 2> point{0, 0};  // Boost's sequence leaves out the origin, with which it begins
  for (std::size_t i = 0; design.size() < count && i < 64 * static_cast<std::size_t>(candidates.size()); ++i) {
    take(design, candidates, coordinate(point[0] ^ shift[0]) * area.width, coordinate(point[1] ^ shift[1]) * area.depth,
         area);
    for (std::uint64_t& axis : point) axis = sequence();
  }
  return design;
}

std::vector<int> draw_lattice(std::size_t count, const Candidates& candidates, const Area& area) {
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

}  // namespace

std::vector<int> initial_design(const InitialOptions& options, const Candidates& candidates, const Area& area,
                                std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(options.count);
  if (options.count > candidates.size()) {
    throw Error("initial.count", fmt::format("{} taps, but there are only {} candidates", count, candidates.size()),
                "take fewer first taps or more candidates");
  }
  Random random(seed, "initial");
  std::vector<int> design;
  switch (options.design) {
    case InitialOptions::Design::random:
      return draw_random(static_cast<int>(count), candidates.size(), random);
    case InitialOptions::Design::sobol:
      design = draw_sobol(count, candidates, area, random);
      break;
    case InitialOptions::Design::grid:
      design = draw_lattice(count, candidates, area);
      break;
  }
  // A design nearly as fine as the candidates themselves meets some of them twice: the free ones follow in order.
  for (int i = 0; design.size() < count; ++i) {
    if (std::find(design.begin(), design.end(), i) == design.end()) design.push_back(i);
  }
  return design;
}

Pick Chooser::pick(const Scores& scores, const std::vector<bool>& allowed, double scale, double tolerance) {
  scores_ = &scores;
  allowed_ = &allowed;
  bounds_.resize(static_cast<std::size_t>(scores.pieces()));
  for (int piece = 0; piece < scores.pieces(); ++piece) bound_of(piece) = scores.bound(piece);

  Pick out;
  const Cell best = find_best(-1);
  if (best.candidate < 0) return out;
  const double bound = tolerance * (std::abs(best.score) + scale);
  const double threshold = best.score - bound;
  for (int piece = 0; piece < scores.pieces(); ++piece) {
    if (bound_of(piece) < threshold) continue;
    for_allowed(piece, [&](const Cell& cell) {
      if (cell.score < threshold) return;
      ++out.ties;
      if (out.candidate >= 0 && cell.candidate > out.candidate) return;
      out.candidate = cell.candidate;
      out.score = cell.score;
    });
  }
  const Cell second = find_best(out.candidate);
  out.runner_up = second.candidate;
  out.runner_up_score = second.score;
  if (best.score <= 0.0) {
    out.flat = "no score is positive";
  } else if (second.candidate >= 0 && !any_below(threshold)) {
    out.flat = "every score is equal";
  }
  return out;
}

template <class Visit>
void Chooser::for_allowed(int piece, const Visit& visit) const {
  std::array<Cell, kMostCells> cells;
  const int count = scores_->read(piece, cells.data());
  for (int i = 0; i < count; ++i) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    if (!(*allowed_)[static_cast<std::size_t>(cell.candidate)]) continue;
    if (!std::isfinite(cell.score)) throw Error("", "a score is not a finite number", {}, Error::Kind::run);
    visit(cell);
  }
}

ScoredCell Chooser::find_best(int except) {
  Cell best{-1, -std::numeric_limits<double>::infinity()};
  const auto look = [&](int piece) {
    double& bound = bound_of(piece);
    bound = -std::numeric_limits<double>::infinity();
    for_allowed(piece, [&](const Cell& cell) {
      bound = std::max(bound, cell.score);
      if (cell.candidate == except) return;
      if (cell.score > best.score || (cell.score == best.score && cell.candidate < best.candidate)) best = cell;
    });
  };
  // Of two passes, the first finds where a good score is, so that the second reads few pieces.
  const auto first = std::max_element(bounds_.begin(), bounds_.end());
  look(static_cast<int>(first - bounds_.begin()));
  for (int piece = 0; piece < scores_->pieces(); ++piece) {
    if (bound_of(piece) >= best.score) look(piece);
  }
  return best;
}

bool Chooser::any_below(double threshold) const {
  bool found = false;
  for (int piece = 0; piece < scores_->pieces() && !found; ++piece) {
    for_allowed(piece, [&](const Cell& cell) { found |= cell.score < threshold; });
  }
  return found;
}

}  // namespace palpate
