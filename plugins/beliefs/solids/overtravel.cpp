// SPDX-License-Identifier: MIT
#include "solids/overtravel.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Prior deviations. A lag of 0.35 s at 2.4 cm/s is 8 mm; what is as soft as 1500 N/m gives way by 0.7 mm a newton.
// Offset in metres, compliance in metres per newton in place of the drift, noise in metres along the path.
constexpr OffsetPrior kPrior{0.006, 0.0005, 0.0012};
// The floor of a vessel is a few millimetres above the desk, and not taken for it: the noise is that of a pose, no
// more. Of flatter ways what the desk's height errs by is too much along the way.
constexpr double kSteep = 0.6;
constexpr double kMeasurable = 1e-6;  // metres: smaller values are rounding

}  // namespace

Overtravel::Overtravel(double tip, double most) : tip_(tip), most_(most), offset_model_(kPrior) {}

/// For a round tip, which is higher than its foremost point if the tool comes at an angle.
double Overtravel::lowest_point(const SurfaceTouch& touch) const {
  return touch.end().z() - tip_ * (1.0 - std::abs(touch.line.direction.z()));
}

double Overtravel::margin() const {
  constexpr double kDeviations = 3.0;
  return std::min(most_, kDeviations * spread_);
}

double Overtravel::at(double force) const {
  const double deep = -offset_model_.at(force).value;
  return deep > kMeasurable ? deep : 0.0;
}

void Overtravel::add(const SurfaceTouch& told, double force) {
  if (!told.contact) return;
  const double height = lowest_point(told);
  const double steep = -told.line.direction.z();
  if (steep < kSteep || height > margin()) return;
  // Each contact has a position of its own. OffsetModel drops low contacts near higher ones as rims. This suits taps
  // from above, but here it would drop the desk near every wall.
  constexpr double kApart = 1.0;
  offset_model_.add({kApart * static_cast<double>(lows_.size()), 0.0}, force, height / steep);
  lows_.push_back({height, steep, force});
  // Prior: two contacts with the smallest spread.
  double count = 2.0;
  double squares = count * kLeastSpread * kLeastSpread;
  for (const Low& low : lows_) {
    const double below = low.height + at(low.force) * low.steep;
    if (below >= 0.0) continue;
    squares += below * below;
    ++count;
  }
  spread_ = std::max(kLeastSpread, std::sqrt(squares / count));
}

SurfaceTouch Overtravel::read(const SurfaceTouch& told, double force) const {
  SurfaceTouch out = told;
  if (!told.contact) return out;
  out.length = std::max(0.0, told.length - at(force));
  out.desk = lowest_point(out) <= margin();
  return out;
}

}  // namespace palpate
