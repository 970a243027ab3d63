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
  if (!options.searches() && options.count > candidates.size()) {
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
    case InitialOptions::Design::search:
      return {};  // one at a time: see Search
  }
  // A design nearly as fine as the candidates themselves meets some of them twice: the free ones follow in order.
  for (int i = 0; design.size() < count; ++i) {
    if (std::find(design.begin(), design.end(), i) == design.end()) design.push_back(i);
  }
  return design;
}

Pick Picker::pick(const Scores& scores, const std::vector<bool>& allowed, double scale, double tolerance) {
  scores_ = &scores;
  allowed_ = &allowed;
  bounds_.resize(static_cast<std::size_t>(scores.pieces()));
  for (int piece = 0; piece < scores.pieces(); ++piece) bounds_[static_cast<std::size_t>(piece)] = scores.bound(piece);

  Pick out;
  find_two();
  if (best_.candidate < 0) return out;
  out.candidate = best_.candidate;
  out.score = best_.score;
  out.ties = 1;
  const double threshold = best_.score - tolerance * (std::abs(best_.score) + scale);
  const bool tied = second_.candidate >= 0 && second_.score >= threshold;
  if (tied) choose_first(threshold, out);
  out.runner_up = second_.candidate;
  if (second_.candidate >= 0) out.runner_up_score = second_.score;
  if (best_.score <= 0.0) {
    out.flat = "no score is positive";
  } else if (tied && !any_below(threshold)) {
    out.flat = "every score is equal";
  }
  return out;
}

template <class Visit>
void Picker::for_allowed(int piece, double least, const Visit& visit) {
  const int count = scores_->read(piece, cells_.data());
  for (int i = 0; i < count; ++i) {
    const Cell& cell = cells_[static_cast<std::size_t>(i)];
    // Not a number is not less.
    if (cell.score < least || !(*allowed_)[static_cast<std::size_t>(cell.candidate)]) continue;
    if (!std::isfinite(cell.score)) throw Error("", "a score is not a finite number", {}, Error::Kind::run);
    visit(cell);
  }
}

void Picker::find_two() {
  best_ = second_ = {-1, -std::numeric_limits<double>::infinity()};
  const auto look = [&](int piece) {
    for_allowed(piece, second_.score, [&](const Cell& cell) {
      if (before(cell, best_)) {
        second_ = std::exchange(best_, cell);
      } else if (before(cell, second_)) {
        second_ = cell;
      }
    });
  };
  // The first piece has two good scores most often, so that few of the others need be read.
  const auto first = static_cast<int>(std::max_element(bounds_.begin(), bounds_.end()) - bounds_.begin());
  look(first);
  for (int piece = 0; piece < scores_->pieces(); ++piece) {
    if (piece != first && bounds_[static_cast<std::size_t>(piece)] >= second_.score) look(piece);
  }
}

void Picker::choose_first(double threshold, Pick& out) {
  // The second best stays the runner-up, unless it is the one that is chosen: then the best is.
  out.ties = 0;
  Cell chosen{-1, 0.0};
  for (int piece = 0; piece < scores_->pieces(); ++piece) {
    if (bounds_[static_cast<std::size_t>(piece)] < threshold) continue;
    for_allowed(piece, threshold, [&](const Cell& cell) {
      ++out.ties;
      if (chosen.candidate < 0 || cell.candidate < chosen.candidate) chosen = cell;
    });
  }
  out.candidate = chosen.candidate;
  out.score = chosen.score;
  if (chosen.candidate != best_.candidate) second_ = best_;
}

bool Picker::any_below(double threshold) {
  bool found = false;
  for (int piece = 0; piece < scores_->pieces() && !found; ++piece) {
    for_allowed(piece, -std::numeric_limits<double>::infinity(),
                [&](const Cell& cell) { found |= cell.score < threshold; });
  }
  return found;
}

bool Picker::before(const Cell& a, const Cell& b) {
  return a.score > b.score || (a.score == b.score && a.candidate < b.candidate) || b.candidate < 0;
}

}  // namespace palpate
