// SPDX-License-Identifier: MIT
#include "labels.hpp"

#include "form.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpate::footprints {

LabelModel::LabelModel(double mistaken, double lies, double blur)
    : blurs_(blur > 0.0), mistake_(0.5 * math::log((1.0 - mistaken) / mistaken)) {
  constexpr double kDeviations = 3.5;  // beyond, the place decides in one of some thousand touches
  // Without a blur a step is so short that no touch is within one of a rim.
  reach_ = kDeviations * std::max(blur, 1e-12);
  steps_per_metre_ = 0.5 * kSteps / reach_;
  for (int place = 0; place < kSteps + 2; ++place) {
    const double depth = ((place - 0.5) / (0.5 * kSteps) - 1.0) * kDeviations;
    double inside = 0.5 * math::erfc(-depth / std::sqrt(2.0));
    if (place == kOutside) inside = 0.0;
    if (place == kInside) inside = 1.0;
    const double on = inside * (1.0 - mistaken) + (1.0 - inside) * lies;
    const double off = inside * mistaken + (1.0 - inside) * (1.0 - lies);
    table_.push_back({off, math::log((1.0 - lies) / off), inside * mistaken / off});
    table_.push_back({on, math::log((1.0 - mistaken) / on), (1.0 - inside) * lies / on});
  }
}

namespace {

// Heights of an object's touches range over so much, metres.
constexpr double kRange = 0.15;
// Standard deviation of the step from one touch to another, metres, and what each metre between them adds.
constexpr double kStep = 0.004;
constexpr double kLevel = 0.05;
constexpr double kSlope = 0.5;
// Shares of the tops that are level, and that have a slope.
constexpr double kLevels = 0.5;
constexpr double kSlopes = 0.3;
// Share of pieces that are as high as what is beside them.
constexpr double kBeside = 0.3;
// Of so many earlier ones one is nearly always in the same piece.
constexpr std::size_t kNeighbours = 8;

/// The logarithm of the density of a height given one so far away, over that of any height. `slope`: standard
/// deviation.
double gain(const Touch& earlier, const Touch& later, double slope) {
  const double distance = math::hypot(later.place.x - earlier.place.x, later.place.y - earlier.place.y);
  const double scale = math::hypot(kStep, slope * distance);
  const double z = (later.height - earlier.height) / scale;
  // One in fifty is an error.
  return math::log(0.98 * math::exp(-0.5 * z * z) / (scale * std::sqrt(2.0 * kPi)) * kRange + 0.02);
}

}  // namespace

void HeightModel::add(const Touch& touch, std::size_t number) {
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const double dx = touch.place.x - touches_[i].place.x;
    const double dy = touch.place.y - touches_[i].place.y;
    nearest.emplace_back(dx * dx + dy * dy, i);
  }
  const std::size_t count = std::min(kNeighbours, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
  std::vector<Neighbour>& neighbours = neighbours_.emplace_back();
  for (std::size_t i = 0; i < count; ++i) {
    const Touch& earlier = touches_[nearest[i].second];
    neighbours.push_back({numbers_[nearest[i].second], gain(earlier, touch, kLevel), gain(earlier, touch, kSlope)});
  }
  beside_.push_back(neighbours.empty() ? 0.0 : math::log(1.0 - kBeside + kBeside * math::exp(neighbours[0].level)));
  touches_.push_back(touch);
  numbers_.push_back(number);
}

double HeightModel::evidence(const std::vector<std::uint16_t>& holders, int pieces) const {
  constexpr std::size_t kMost = 16;  // bits
  std::array<double, kMost> level{};
  std::array<double, kMost> slope{};
  double out = 0.0;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    unsigned held = holders[numbers_[i]];
    if (held == 0) continue;
    const double part = (held & (held - 1)) == 0 ? 1.0 : 1.0 / __builtin_popcount(held);  // most are held by one
    for (const Neighbour& neighbour : neighbours_[i]) {
      const unsigned both = held & holders[neighbour.touch];
      if (both == 0) continue;
      held &= ~both;
      for (unsigned left = both; left != 0; left &= left - 1) {
        const auto piece = static_cast<std::size_t>(__builtin_ctz(left));
        level[piece] += part * neighbour.level;
        slope[piece] += part * neighbour.slope;
      }
      if (held == 0) break;
    }
    if (held != 0 && !neighbours_[i].empty()) out += part * __builtin_popcount(held) * beside_[i];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(pieces); ++i) {
    const double most = std::max({level[i], slope[i], 0.0});
    out += most + math::log(kLevels * math::exp(level[i] - most) + kSlopes * math::exp(slope[i] - most) +
                            (1.0 - kLevels - kSlopes) * math::exp(-most));
  }
  return out;
}

}  // namespace palpate::footprints
