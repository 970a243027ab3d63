// SPDX-License-Identifier: MIT
#include "experiment/search_design.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// In a test with 200 cubes of 3 cm, an inexact arm found 96 % of the cubes within 60 taps. It also found 96 % with
// twice as many discs, but only 92 % with a quarter of the discs. The objects of Sun and Min 2021 are found at tap 1.8
// on average, with any of these numbers of discs.
constexpr int kDiscs = 16000;
constexpr int kWhole = 1000;
// Errors of an arm of Baxter's class: standard deviation of the tip's position, metres (kBlur), and probability that
// the arm does not detect a contact (kMissed). The search assumes these errors for every arm. A perfect arm finds the
// same cubes equally soon with and without this assumption. The assumed position error acts as a margin around the
// discs, which covers the corners of boxes.
constexpr double kBlur = 0.002;
constexpr double kMissed = 0.02;
constexpr double kFar = 5.0 * kBlur;

/// Returns the probability that a tap does not find an object. `inside`: distance of the tap from the object's edge,
/// metres; positive inside the object, negative outside.
double passed_by(double inside) { return 1.0 - (1.0 - kMissed) * 0.5 * math::erfc(-inside / (kBlur * std::sqrt(2.0))); }

double between(double least, double most, Random& random) { return least + (most - least) * random.uniform(); }

// rounded_up() and rounded_down() replace std::ceil and std::floor, which are slow function calls without SSE4.1.
int rounded_up(double t) {
  const int whole = static_cast<int>(t);
  return whole + (whole < t ? 1 : 0);
}
int rounded_down(double t) {
  const int whole = static_cast<int>(t);
  return whole - (whole > t ? 1 : 0);
}

/// Indices of the first and the last position within [low, high], among the `count` positions start, start + step, ....
/// If there is no such position, `last` is less than `first`.
struct Span {
  Span(double low, double high, double start, double step, int count)
      : first(std::max(0, rounded_up((low - start) / step))),
        last(std::min(count - 1, rounded_down((high - start) / step))) {}
  int first, last;
};

double step_of(const Eigen::VectorXd& places) { return places.size() > 1 ? places(1) - places(0) : 1.0; }

}  // namespace

SearchDesign::SearchDesign(double smallest, const CandidateGrid& candidates, const Area& area, Random random)
    : smallest_(smallest), candidates_(candidates), area_(area), random_(random) {}

void SearchDesign::draw_discs() {
  rises_.assign(static_cast<std::size_t>(candidates_.rows) * static_cast<std::size_t>(candidates_.columns + 1), 0);
  const double ratio = math::log(std::min(area_.width, area_.depth) / smallest_);
  discs_.reserve(kDiscs);
  for (int i = 0; i < kDiscs; ++i) {
    const double radius = 0.5 * smallest_ * math::exp(ratio * random_.uniform());
    const double x = between(radius, area_.width - radius, random_);
    const double y = between(radius, area_.depth - radius, random_);
    discs_.push_back({x, y, radius, kWhole});
    weigh(discs_.back(), kWhole);
  }
}

void SearchDesign::look(const Target& place) { looked_.push_back(place); }

void SearchDesign::strike_off(const Target& place) {
  for (Disc& disc : discs_) {
    const double dx = place.x - disc.x;
    const double dy = place.y - disc.y;
    const double square = dx * dx + dy * dy;
    if (square > (disc.radius + kFar) * (disc.radius + kFar)) continue;
    const double inside = disc.radius - std::sqrt(square);
    const int left = static_cast<int>(std::lround(disc.weight * passed_by(inside)));
    if (left == disc.weight) continue;
    weigh(disc, left - disc.weight);
    disc.weight = left;
  }
  const auto is_done = [](const Disc& disc) { return disc.weight == 0; };
  discs_.erase(std::remove_if(discs_.begin(), discs_.end(), is_done), discs_.end());
}

int SearchDesign::next(const Allowed& allowed) {
  if (rises_.empty()) draw_discs();
  while (struck_off_ < looked_.size()) strike_off(looked_[struck_off_++]);
  const std::vector<int> weight = weights();
  int best = -1;
  int most = -1;
  double widest = 0.0;
  for (int i = 0; i < candidates_.size(); ++i) {
    const int here = weight[static_cast<std::size_t>(i)];
    if (!allowed(i) || here < most) continue;
    const double gap = room(candidates_.target(i));
    if (here == most && gap <= widest) continue;
    best = i;
    most = here;
    widest = gap;
  }
  return best;
}

void SearchDesign::weigh(const Disc& disc, int weight) {
  // The candidates of a row that lie in a disc are consecutive.
  const double across = step_of(candidates_.xs);
  const double along = step_of(candidates_.ys);
  const Span rows(disc.y - disc.radius, disc.y + disc.radius, candidates_.ys(0), along, candidates_.rows);
  for (int row = rows.first; row <= rows.last; ++row) {
    const double dy = candidates_.ys(row) - disc.y;
    const double half = std::sqrt(std::max(0.0, disc.radius * disc.radius - dy * dy));
    const Span cut(disc.x - half, disc.x + half, candidates_.xs(0), across, candidates_.columns);
    if (cut.first > cut.last) continue;
    int* const rises = rises_.data() + static_cast<std::ptrdiff_t>(row) * (candidates_.columns + 1);
    rises[cut.first] += weight;
    rises[cut.last + 1] -= weight;
  }
}

std::vector<int> SearchDesign::weights() const {
  std::vector<int> out;
  out.reserve(static_cast<std::size_t>(candidates_.size()));
  auto rise = rises_.begin();
  for (int row = 0; row < candidates_.rows; ++row, ++rise) {
    int weight = 0;
    for (int column = 0; column < candidates_.columns; ++column) out.push_back(weight += *rise++);
  }
  return out;
}

double SearchDesign::room(const Target& place) const {
  double out = std::min({place.x, area_.width - place.x, place.y, area_.depth - place.y});
  for (const Target& tap : looked_) out = std::min(out, math::hypot(place.x - tap.x, place.y - tap.y));
  return out;
}

}  // namespace palpate
