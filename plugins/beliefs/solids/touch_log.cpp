// SPDX-License-Identifier: MIT
#include "solids/touch_log.hpp"

namespace palpate {
namespace {

/// Depth below the desk, metres, at which a tool must have felt the desk.
constexpr double kFeltLate = 0.03;

}  // namespace

void TouchLog::look(std::vector<SurfaceTouch> seen, bool shows_object) {
  touches_ = std::move(seen);
  seen_ = touches_.size();
  is_object_seen_ = shows_object;
}

std::optional<TouchLog::ReportedTouch> TouchLog::reported(const TapRequest& request, const TapResult& result) const {
  if (result.outcome != Outcome::contact && result.outcome != Outcome::no_contact) return std::nullopt;
  SurfaceTouch touch;
  touch.line = {request.line.start - Eigen::Vector3d(0.0, 0.0, desk_), request.line.direction};
  touch.length = result.distance.value_or(request.line.length);
  touch.contact = result.is_contact();
  if (!touch.contact && touch.end().z() < -kFeltLate) return std::nullopt;
  return ReportedTouch{touch, result.force, request.number};
}

std::optional<TapReading> TouchLog::read(const TapRequest& request, const TapResult& result) const {
  const std::optional<ReportedTouch> one = reported(request, result);
  return one ? std::optional(reading(overtravel_.read(one->touch, one->force), one->tap)) : std::nullopt;
}

void TouchLog::add(const TapRequest& request, const TapResult& result) {
  taps_.add(request);
  const std::optional<ReportedTouch> one = reported(request, result);
  if (!one) return;
  reported_.push_back(*one);
  const double before = overtravel_.spread();
  overtravel_.add(one->touch, one->force);
  has_changed_ = has_changed_ || overtravel_.spread() != before;
  touches_.resize(seen_ + reported_.size());
  taps_.readings.resize(reported_.size());
  for (std::size_t i = 0; i < reported_.size(); ++i) {
    const SurfaceTouch touch = overtravel_.read(reported_[i].touch, reported_[i].force);
    SurfaceTouch& known = touches_[seen_ + i];
    const bool is_last = i + 1 == reported_.size();
    has_changed_ = has_changed_ || (!is_last && (touch.length != known.length || touch.desk != known.desk));
    known = touch;
    taps_.readings[i] = reading(touch, reported_[i].tap);
  }
}

TapReading TouchLog::reading(const SurfaceTouch& touch, int tap) const {
  TapReading out;
  out.tap = tap;
  out.position = touch.end() + Eigen::Vector3d(0.0, 0.0, desk_);
  out.is_contact = touch.contact;
  out.on_object = touch.contact && !touch.desk;
  return out;
}

}  // namespace palpate
