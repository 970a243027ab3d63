// SPDX-License-Identifier: MIT
#include "tap_model.hpp"

#include "hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace palpate::footprints {
namespace {

// Heights are uniform over this range, metres.
constexpr double kHeightRange = 0.15;
// Standard deviation of the difference of two heights, metres, and its growth per metre of distance.
constexpr double kHeightNoise = 0.004;
constexpr double kLevelGrowth = 0.05;
constexpr double kSlopeGrowth = 0.5;
// Fractions of level and of sloped tops.
constexpr double kLevels = 0.5;
constexpr double kSlopes = 0.3;
// Fraction of primitives whose first height is similar to that of the nearest earlier tap outside.
constexpr double kContinued = 0.3;
// Number of nearest earlier taps that are searched; nearly always, one of them is in the same primitive.
constexpr std::size_t kNeighbours = 8;

/// Returns the logarithm of a height's density given an earlier height, relative to the uniform density.
double gain(const Touch& earlier, const Touch& later, double growth) {
  const double distance = math::hypot(later.place.x - earlier.place.x, later.place.y - earlier.place.y);
  const double scale = math::hypot(kHeightNoise, growth * distance);
  const double z = (later.height - earlier.height) / scale;
  // One height in fifty is an outlier.
  return math::log(0.98 * math::exp(-0.5 * z * z) / (scale * std::sqrt(2.0 * kPi)) * kHeightRange + 0.02);
}

}  // namespace

LogUnits to_units(double logarithm) { return std::llround(logarithm * 0x1p20); }

LabelModel::LabelModel(double label_error, double false_contact, double noise)
    : contradictions_{to_units(0.5 * math::log((1.0 - false_contact) / label_error)),
                      to_units(0.5 * math::log((1.0 - label_error) / false_contact))} {
  constexpr double kDeviations = 3.5;  // if the rim is farther away, noise moves less than one tap in 4000 across it
  // Without noise, the steps are so short that no tap is within one step of a rim.
  reach_ = kDeviations * std::max(noise, 1e-12);
  steps_per_metre_ = 0.5 * kSteps / reach_;
  for (int step = 0; step < kSteps + 2; ++step) {
    const double deviations = ((step - 0.5) / (0.5 * kSteps) - 1.0) * kDeviations;
    double inside = 0.5 * math::erfc(-deviations / std::sqrt(2.0));
    if (step == kOutside) inside = 0.0;
    if (step == kInside) inside = 1.0;
    const double on = inside * (1.0 - label_error) + (1.0 - inside) * false_contact;
    const double off = inside * label_error + (1.0 - inside) * (1.0 - false_contact);
    table_.push_back({off, inside * label_error / off});
    table_.push_back({on, (1.0 - inside) * false_contact / on});
    losses_.push_back(static_cast<std::int32_t>(to_units(math::log((1.0 - false_contact) / off))));
    losses_.push_back(static_cast<std::int32_t>(to_units(math::log((1.0 - label_error) / on))));
  }
}

LabelModel::Step LabelModel::step(double depth) const {
  const double steps = depth * steps_per_metre_ + 0.5 * kSteps;
  return static_cast<Step>(std::min(std::max(steps, -1.0), 1.0 * kSteps) + 1.0);
}

LogUnits LabelModel::loss(const Step* steps, const Step* labels, int length) const {
  LogUnits out = 0;
  for (int from = 0; from < length; from += 8) {
    if (std::memcmp(steps + from, labels + from, 8) == 0) continue;  // most labels are correct and far from a rim
    for (int i = from; i < from + 8; ++i) out += loss(steps[i], labels[i] == kInside);
  }
  return out;
}

void TapHeightModel::add(const Touch& touch) {
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    const double dx = touch.place.x - taps_[i].touch.place.x;
    const double dy = touch.place.y - taps_[i].touch.place.y;
    nearest.emplace_back(dx * dx + dy * dy, i);
  }
  const std::size_t count = std::min(kNeighbours, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
  Tap tap;
  tap.touch = touch;
  for (std::size_t i = 0; i < count; ++i) {
    const Touch& earlier = taps_[nearest[i].second].touch;
    const double level = gain(earlier, touch, kLevelGrowth);
    tap.neighbours.push_back({nearest[i].second, to_units(level), to_units(gain(earlier, touch, kSlopeGrowth))});
    if (i == 0) tap.first = to_units(math::log(1.0 - kContinued + kContinued * math::exp(level)));
  }
  taps_.push_back(std::move(tap));
}

LogUnits TapHeightModel::evidence(const std::vector<std::uint16_t>& holders, int primitives) const {
  constexpr std::size_t kMost = 16;  // number of bits per entry of `holders`
  std::array<LogUnits, kMost> level{};
  std::array<LogUnits, kMost> slope{};
  LogUnits out = 0;
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    unsigned left = holders[i];
    if (left == 0) continue;
    const int count = __builtin_popcount(left);
    const auto part = [count](LogUnits units) { return count == 1 ? units : units / count; };
    for (const Neighbour& neighbour : taps_[i].neighbours) {
      for (unsigned both = left & holders[neighbour.tap]; both != 0; both &= both - 1) {
        const auto primitive = static_cast<std::size_t>(__builtin_ctz(both));
        level[primitive] += part(neighbour.level);
        slope[primitive] += part(neighbour.slope);
      }
      left &= ~unsigned{holders[neighbour.tap]};
      if (left == 0) break;
    }
    if (left != 0) out += part(taps_[i].first) * __builtin_popcount(left);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(primitives); ++i) {
    const LogUnits most = std::max({level[i], slope[i], LogUnits{0}});
    const auto relative = [most](LogUnits units) { return math::exp(from_units(units - most)); };
    out += most + to_units(math::log(kLevels * relative(level[i]) + kSlopes * relative(slope[i]) +
                                     (1.0 - kLevels - kSlopes) * relative(0)));
  }
  return out;
}

}  // namespace palpate::footprints
