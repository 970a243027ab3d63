// SPDX-License-Identifier: MIT
#include "simulator/simulator.hpp"

#include "simulator/arm.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

namespace palpate::backends {

Simulator::Simulator(const Options& options, const Context& context)
    : options_(options), context_(context), scene_(context.scene) {
  const Effects& effects = scene_.effects();
  moves_ = effects.force_noise || effects.force_drift || effects.stiffness || effects.joint_lag || effects.latency ||
           effects.missed_contacts || effects.false_contacts;
  perfect_ = effects.empty();
  if (context.from_above && scene_.highest() >= scene_.desk() + options.motion.at(0).hover)
    throw Error("motion.hover",
                fmt::format("an object is {:g} cm high, but the arm travels at {:g} cm",
                            100.0 * (scene_.highest() - scene_.desk()), 100.0 * options.motion.at(0).hover),
                "raise motion.hover or lower the object");
}

TapResult Simulator::tap(const TapRequest& request) {
  TapResult out = request.line.from_above ? tap_from_above(request) : tap_along(request);
  if (!wait(out.seconds)) out = tap_without_contact(Outcome::aborted, out.seconds, "interrupted");
  return out;
}

TapResult Simulator::tap_from_above(const TapRequest& request) {
  const tapping::MotionOptions& motion = options_.motion.of_request(request);
  const PlannedDescent down{motion, tapping::plan_descent(motion, scene_.desk(), request.predicted)};
  if (!perfect_) {
    if (scene_.effects().push) pushed_ = scene_.after(request.number - 1);
    return imperfect_tap(request, down, pushed_ ? *pushed_ : scene_);
  }
  const Target target = request.line.target();
  tapping::HeightResult contact = ideal_tap(down, scene_.height(target.x, target.y));
  contact.seconds += tapping::travel_seconds(motion, request);
  return tapping::result_on(request.line, std::move(contact));
}

bool Simulator::beyond_reach(double x, double y) const {
  const auto& reach = scene_.effects().reach;
  return reach && math::hypot(x - reach->base[0], y - reach->base[1]) > reach->radius;
}

Eigen::Vector3d Simulator::pose_error(const TapRequest& request) const {
  const auto& noise = scene_.effects().pose_noise;
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  if (!noise) return out;
  GaussianNumbers normal(context_.random("simulator/pose", static_cast<std::uint64_t>(request.number)));
  for (const Eigen::Index axis : {0, 1, 2}) out(axis) = (axis == 2 ? noise->vertical : noise->lateral) * normal();
  return out;
}

void Simulator::reaches(const Candidates& lines, BoolOut out) const {
  for (Eigen::Index i = 0; i < lines.size(); ++i) out(i) = reaches(lines.line(i));
}

/// Returns whether the start of the line is within the arm's reach, and the tip and the whole shaft are above the desk
/// there.
bool Simulator::reaches(const TapLine& line) const {
  const Effects& effects = scene_.effects();
  const double above = line.start.z() - scene_.desk();
  if (above <= (effects.tip_radius ? effects.tip_radius->radius : 0.0)) return false;
  if (beyond_reach(line.start.x(), line.start.y())) return false;
  if (!effects.shaft) return true;
  const double level = std::sqrt(std::max(0.0, 1.0 - line.direction.z() * line.direction.z()));
  return line.direction.z() <= 0.0 && above > effects.shaft->radius * level;
}

tapping::HeightResult Simulator::ideal_tap(const PlannedDescent& tap, double surface) const {
  const double down = tapping::ideal_seconds(tap.motion, tap.descent, surface);
  const double up = tapping::retreat_seconds(tap.motion, tap.descent, surface);
  if (down > tap.motion.timeout) return {Outcome::timeout, 0.0, 0.0, tap.motion.timeout + up, tapping::kTooLong};
  return {Outcome::contact, surface, tap.motion.threshold, down + up, {}};
}

/// Taps along an approach from any side, with the motion of a vertical tap. The remaining length of the approach takes
/// the place of the height. Pose errors and height offset move the true line.
TapResult Simulator::tap_along(const TapRequest& request) const {
  const tapping::MotionOptions& motion = options_.motion.of_request(request);
  const Effects& effects = scene_.effects();
  const TapLine& line = request.line;
  const double length = line.length;
  Line true_line{line.start + pose_error(request), line.direction};
  if (effects.height_offset)
    true_line.origin.z() -= effects.height_offset->constant + effects.height_offset->drift * request.elapsed;
  const std::unique_ptr<const Scene> pushed = scene_.after(request.number - 1);
  const Scene& scene = pushed ? *pushed : scene_;
  double along = contact_along(scene, effects, true_line);
  // A round tip may touch the desk with its side. The tool therefore touches the desk if contact_along() and
  // desk_along() give the same distance.
  constexpr double kAsExact = 1e-6;  // metres; more than the accuracy of both searches
  const bool desk = effects.stiffness && along > desk_along(scene, effects, true_line) - kAsExact;
  const Eigen::Vector3d met = true_line.origin + std::min(along, length) * true_line.direction;
  if (effects.foreign_objects)
    along -= foreign_object_height(*effects.foreign_objects, context_.seed, met.x(), met.y());
  const PlannedDescent way{motion, {length, length, 0.0}};
  const bool met_any = along <= length;
  const double left = met_any ? std::max(0.0, length - along) : -motion.overrun;
  tapping::HeightResult end =
      moves_ ? simulated_tap(request.number, way, left, desk) : ideal_tap(way, std::max(0.0, left));
  if (!moves_ && !met_any && end.outcome == Outcome::contact) end.outcome = Outcome::no_contact;
  // Without a contact, the arm ends at the full length, even if an object is there.
  const double distance = end.outcome == Outcome::contact ? length - end.height : length;
  end.height = line.start.z() + distance * line.direction.z();
  end.seconds += tapping::travel_seconds(motion, request);
  TapResult out = tapping::result_on(line, end);
  out.distance = distance;
  if (out.is_contact()) out.contact->head<2>() = line.at(distance).head<2>();
  return out;
}

TapResult Simulator::imperfect_tap(const TapRequest& request, const PlannedDescent& tap, const Scene& scene) const {
  const Effects& effects = scene_.effects();
  const Target target = request.line.target();
  if (beyond_reach(target.x, target.y))
    return tap_without_contact(Outcome::unreachable, 0.0, "beyond the reach of the arm");
  const Eigen::Vector3d error = pose_error(request);
  const double x = target.x + error.x();
  const double y = target.y + error.y();
  double surface = contact_height(scene, effects, x, y);
  const bool desk = surface <= scene_.desk();
  if (effects.foreign_objects)
    surface =
        std::min(surface + foreign_object_height(*effects.foreign_objects, context_.seed, x, y), tap.descent.hover);
  tapping::HeightResult contact = moves_ ? simulated_tap(request.number, tap, surface, desk) : ideal_tap(tap, surface);
  contact.seconds += tapping::travel_seconds(tap.motion, request);
  double dz = error.z();
  if (effects.height_offset) dz += effects.height_offset->constant + effects.height_offset->drift * request.elapsed;
  if (contact.outcome == Outcome::contact) contact.height += dz;
  return tapping::result_on(request.line, std::move(contact));
}

tapping::HeightResult Simulator::simulated_tap(int number, const PlannedDescent& tap, double surface, bool desk) const {
  using tapping::GuardedTap;
  const Effects& effects = scene_.effects();
  ContactModel sensor(effects, surface, desk, tap.descent.hover, tap.motion.threshold,
                      context_.random("simulator/touch", static_cast<std::uint64_t>(number)));
  SimulatedAxis arm(effects.joint_lag, GuardedTap::kPeriod, tap.descent.hover);
  GuardedTap guarded(tap.motion, tap.descent);
  const std::optional<double>& limit = tap.motion.force_limit;
  tapping::Sample felt{};
  while (!guarded.done()) {
    felt = sensor.measure(arm.position());
    if (limit && sensor.force() > tapping::kOwnStop * *limit && !guarded.stopping()) guarded.give_up(felt.height);
    arm.follow(guarded.next(felt.height, felt.force));
  }
  tapping::HeightResult contact = guarded.result();
  contact.seconds = guarded.seconds() + tapping::retreat_seconds(tap.motion, tap.descent, felt.height);
  contact.peak_force = sensor.peak();
  return contact;
}

/// Waits for the duration of the tap multiplied by `pace`, in short sleeps. Returns false if the user has interrupted
/// the wait.
bool Simulator::wait(double tap_seconds) const {
  using Clock = std::chrono::steady_clock;
  const double seconds = tap_seconds * options_.pace;
  if (!(seconds > 0.0)) return true;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (Clock::now() < end) {
    if (context_.interrupted != nullptr && context_.interrupted->load()) return false;
    std::this_thread::sleep_for(std::min<Clock::duration>(end - Clock::now(), std::chrono::milliseconds(10)));
  }
  return true;
}

}  // namespace palpate::backends
