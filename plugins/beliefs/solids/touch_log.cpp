// SPDX-License-Identifier: MIT
#include "solids/touch_log.hpp"

namespace palpate {
namespace {

/// Depth below the desk, metres, at which a tool must have felt the desk.
constexpr double kFeltLate = 0.03;

}  // namespace

void TouchLog::look(const std::vector<SurfaceTouch>& seen) {
  touches_ = seen;
  seen_ = seen.size();
}

std::optional<TouchLog::Reported> TouchLog::reported(const TapRequest& request, const TapResult& result) const {
  if (result.outcome != Outcome::contact && result.outcome != Outcome::no_contact) return std::nullopt;
  SurfaceTouch touch;
  touch.line = {request.line.start - Eigen::Vector3d(0.0, 0.0, desk_), request.line.direction};
  touch.length = result.distance.value_or(request.line.length);
  touch.contact = result.is_contact();
  if (!touch.contact && touch.end().z() < -kFeltLate) return std::nullopt;
  return Reported{touch, result.force, request.number};
}

std::optional<SurfaceTouch> TouchLog::read(const TapRequest& request, const TapResult& result) const {
  const std::optional<Reported> one = reported(request, result);
  return one ? std::optional(overtravel_.read(one->touch, one->force)) : std::nullopt;
}

void TouchLog::add(const TapRequest& request, const TapResult& result) {
  const std::optional<Reported> one = reported(request, result);
  if (!one) return;
  reported_.push_back(*one);
  const double before = overtravel_.spread();
  overtravel_.add(one->touch, one->force);
  has_changed_ = has_changed_ || overtravel_.spread() != before;
  touches_.resize(seen_ + reported_.size());
  for (std::size_t i = 0; i < reported_.size(); ++i) {
    const SurfaceTouch touch = overtravel_.read(reported_[i].touch, reported_[i].force);
    SurfaceTouch& known = touches_[seen_ + i];
    const bool is_last = i + 1 == reported_.size();
    has_changed_ = has_changed_ || (!is_last && (touch.length != known.length || touch.desk != known.desk));
    known = touch;
  }
}

std::vector<TapReading> TouchLog::readings() const {
  std::vector<TapReading> out;
  for (std::size_t i = 0; i < reported_.size(); ++i) {
    const SurfaceTouch& touch = touches_[seen_ + i];
    TapReading one;
    one.tap = reported_[i].tap;
    one.position = touch.end() + Eigen::Vector3d(0.0, 0.0, desk_);
    one.is_contact = touch.contact;
    one.on_object = touch.contact && !touch.desk;
    out.push_back(one);
  }
  return out;
}

}  // namespace palpate
