// SPDX-License-Identifier: MIT
// Force rules of MotionGuard: the force must be renewed and must not be too strong, and nothing may hold the tool.
#include "baxter/motion_guard.hpp"

#include "baxter/error_texts.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::baxter {
namespace {

using AllowedAction = Fault::AllowedAction;

/// Returns the pull in N. A press changes the force in the direction `rise.sign`, a pull in the opposite direction.
double pull_force(const MotionGuard::RiseLimits& rise, const EndpointReading& endpoint) {
  return rise.sign * (rise.zero - endpoint.force.z());
}

/// Returns the fault of a caught tool. `reflex`: whether the firmware has also stopped the arm.
Fault caught_fault(double newtons, const Eigen::Vector3d& tip, bool reflex) {
  return {fmt::format("the tool is caught: it is pulled with {:.0f} N at ({:.1f}, {:.1f}, {:.1f}) cm of the scene. "
                      "Find what holds the tool, and free it by hand before the arm moves up again",
                      newtons, 100 * tip.x(), 100 * tip.y(), 100 * tip.z()),
          AllowedAction::hold, true, reflex};
}

}  // namespace

bool Renewals::take(const EndpointReading& endpoint, double now) {
  while (!readings_.empty() && readings_.front().time < now - ReadingCounter::kWindow - ReadingCounter::kSlack)
    readings_.pop_front();
  if (endpoint.renewals == last_.renewals) return false;
  last_ = {now, endpoint.count, endpoint.renewals};
  readings_.push_back(last_);
  most_ = std::max(most_, count());
  const auto renewals = static_cast<double>(last_.renewals - readings_.front().renewals);
  if (renewals < 2.0) return true;
  known_ = true;
  messages_ = std::max(1.0, static_cast<double>(last_.count - readings_.front().count) / renewals);
  seconds_ = (now - readings_.front().time) / renewals;
  return true;
}

int Renewals::count() const {
  return readings_.empty() ? 0 : static_cast<int>(readings_.back().renewals - readings_.front().renewals + 1);
}

std::optional<Fault> MotionGuard::check_frozen(const EndpointReading& endpoint, double now) const {
  if (!renewals_.known()) return std::nullopt;
  const long equal = renewals_.equal(endpoint);
  const double times = static_cast<double>(equal) / renewals_.messages();
  if (times < kFewestFrozen || (times < kFrozen && renewals_.equal_for(now) < kFrozenFor)) return std::nullopt;
  return Fault{fmt::format("endpoint_state has had exactly the same force for {} messages, but changed every {:.1f} "
                           "before: its publisher is frozen, restart the robot",
                           equal, renewals_.messages()),
               AllowedAction::hold};
}

/// Returns the fault to report after the firmware's reflex: a caught tool if the arm was rising against a pull.
std::optional<Fault> MotionGuard::reflex_fault(const Snapshot& seen, const Eigen::Vector3d& tip) const {
  if (motion_.rise) {
    const double pulls = pull_force(*motion_.rise, *seen.endpoint);
    if (pulls > 0.25 * motion_.rise->limit) return caught_fault(pulls, tip, true);
  }
  return Fault{
      "the arm's own reflex stopped it, at 16 N or at an impact: lower motion.speed or motion.threshold, or check what "
      "the arm hit",
      AllowedAction::retreat, true, true};
}

std::optional<Fault> MotionGuard::check_pull(const Snapshot& seen, const Eigen::Vector3d& tip, double since) {
  if (!motion_.rise) return std::nullopt;
  RiseLimits& rise = *motion_.rise;
  const double pulls = pull_force(rise, *seen.endpoint);
  if (rise.follows == ZeroMode::follows) {
    if (!motion_.anchor) motion_.anchor = StateSinceBegin::ZeroReference{rise.zero, tip.z()};
    const double most = kMostDrift * std::max(0.0, tip.z() - motion_.anchor->height);
    rise.zero -= rise.sign * pulls * std::min(1.0, since / kRiseFollows);
    rise.zero = std::clamp(rise.zero, motion_.anchor->zero - most, motion_.anchor->zero + most);
  }
  motion_.pulled = pulls > rise.limit ? motion_.pulled + 1 : 0;
  if (motion_.pulled < kForceSamples) return std::nullopt;
  return caught_fault(pulls, tip, false);
}

std::optional<Fault> MotionGuard::check_force(const Snapshot& seen, const Eigen::Vector3d& tip) {
  if (!fresh_) return std::nullopt;
  const double since = motion_.felt_at ? seen.now - *motion_.felt_at : 0.0;
  motion_.felt_at = seen.now;
  if (auto fault = check_pull(seen, tip, since)) return fault;
  if (!motion_.tare) return std::nullopt;
  const Eigen::Vector3d felt = seen.endpoint->force - *motion_.tare;
  const double change =
      zero_ == ZeroMode::follows ? felt.norm() : std::max(std::abs(felt.z()), felt.head<2>().norm() / kSideways);
  if (zero_ == ZeroMode::follows) *motion_.tare += felt * std::min(1.0, since / kZeroFollows);
  motion_.too_strong = change > force_stop_ ? motion_.too_strong + 1 : 0;
  if (motion_.too_strong < kForceSamples) return std::nullopt;
  return Fault{fmt::format("the force changed by {:.1f} N, more than force_stop allows: lower motion.speed or "
                           "motion.threshold, or check what the arm hit",
                           change),
               AllowedAction::retreat};
}

}  // namespace palpate::baxter
