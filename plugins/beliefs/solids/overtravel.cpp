// SPDX-License-Identifier: MIT
#include "solids/overtravel.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Prior standard deviations: offset in metres, compliance in metres per newton (in place of the drift), and noise in
// metres along the path. A lag of 0.35 s at 2.4 cm/s is an offset of 8 mm. A stiffness of 1500 N/m is a compliance of
// 0.7 mm/N. The noise covers only the error of a pose. With a larger noise, the floor of a vessel, a few millimetres
// above the desk, would be mistaken for the desk.
constexpr OffsetPrior kPrior{0.006, 0.0005, 0.0012};
// Smallest downward component of the direction. On flatter paths, an error of the desk's height is too large along the
// path.
constexpr double kSteep = 0.6;
constexpr double kMeasurable = 1e-6;  // metres: smaller values are rounding

}  // namespace

Overtravel::Overtravel(double tip, double most) : tip_(tip), most_(most), offset_model_(kPrior) {}

/// Returns the height of the lowest point of the round tip. It is below the foremost point if the tool moves at an
/// angle.
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
  // Each contact gets an artificial position, far from all others. Otherwise OffsetModel would leave out low contacts
  // near higher ones, because they may be at a rim. That suits taps from above, but here it would leave out contacts
  // with the desk near every wall.
  constexpr double kApart = 1.0;
  offset_model_.add({kApart * static_cast<double>(lows_.size()), 0.0}, force, height / steep);
  lows_.push_back({height, steep, force});
  // Prior: two contacts with the smallest spread.
  double count = 2.0;
  double squares = count * kLeastSpread * kLeastSpread;
  for (const LowContact& low : lows_) {
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
