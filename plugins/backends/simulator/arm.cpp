// SPDX-License-Identifier: MIT
#include "simulator/arm.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace palpate::backends {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Stiffness in N/m for scenes without the effect `stiffness`. Object and arm are then nearly rigid: for a force of 10
/// N, the set-point is 0.1 mm below the contact.
constexpr double kRigidArm = 1e5;
/// Force of a false contact, as a multiple of the threshold.
constexpr double kJerk = 2.0;

constexpr int kRings = 8;
constexpr int kSpokes = 24;
constexpr double kFinest = 1e-8;  ///< metres; smallest step of the search

/// Returns the maximum of height(dx, dy) - rise(distance) over a disc, at least `least`. `rise` is the height of the
/// tool's surface above its lowest point, as a function of the distance from the tool's axis. It must not decrease with
/// the distance.
template <class Height, class Rise>
double maximum_over_disc(Height height, double radius, double least, Rise rise) {
  double best = least;
  double at_x = 0.0;
  double at_y = 0.0;
  const auto attempt = [&](double dx, double dy) {
    const double distance = math::hypot(dx, dy);
    if (distance > radius) return false;
    const double value = height(dx, dy) - rise(distance);
    if (!(value > best)) return false;
    best = value;
    at_x = dx;
    at_y = dy;
    return true;
  };
  for (int ring = 1; ring <= kRings; ++ring) {
    // The points are slightly inside the disc, because rounding could otherwise exclude the points on its rim.
    const double distance = radius * ring / kRings * (1.0 - 1e-12);
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2.0 * kPi * spoke / kSpokes;
      attempt(distance * math::cos(angle), distance * math::sin(angle));
    }
  }
  if (best == least) return best;
  for (double stride = radius / kRings; stride > kFinest; stride /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int i = 0; i < 8; ++i) {
        const double angle = kPi / 4 * i;
        moved = attempt(at_x + stride * math::cos(angle), at_y + stride * math::sin(angle)) || moved;
      }
    }
  }
  return best;
}

/// Returns the height of the tool's lowest point at which any part of the tool first touches the scene. height_at(dx,
/// dy) is the height of the scene at a displacement from the tool's axis. No height exceeds `highest`.
template <class Height>
double touch_height(const Effects& effects, double highest, const Height& height_at) {
  double height = height_at(0.0, 0.0);
  if (effects.tip_radius) {
    const double radius = effects.tip_radius->radius;
    height = maximum_over_disc(height_at, radius, height, [radius](double distance) {
      return radius - std::sqrt(std::max(0.0, radius * radius - distance * distance));
    });
  }
  // The comparison with `highest` avoids most searches, because objects rarely reach the lower end of the shaft.
  if (effects.shaft && highest - effects.shaft->length > height)
    height = maximum_over_disc(height_at, effects.shaft->radius, height, [&](double) { return effects.shaft->length; });
  return height;
}

/// Returns the distance along `line` at which any part of the tool touches. `free` returns the free length of a line
/// that is parallel to `line`.
template <class Free>
double touch_distance(const Effects& effects, const Line& line, const Free& free) {
  const Eigen::Vector3d one = line.direction.unitOrthogonal();
  const Eigen::Vector3d other = line.direction.cross(one);
  // The distances are negated, because a near obstacle corresponds to a high surface.
  return -touch_height(effects, 0.0, [&](double dx, double dy) {
    return -free({line.origin + dx * one + dy * other, line.direction});
  });
}

}  // namespace

// The deviation d = position - set-point obeys d'' + 2 * zeta * omega * d' + omega^2 * d = 0. If the set-point moves
// with the speed v, the arm lags behind it by (2 * zeta / omega) * v = delay * v. After a step of the set-point, the
// arm overshoots by exp(-pi * zeta / sqrt(1 - zeta^2)) times the size of the step.
SimulatedAxis::SimulatedAxis(const std::optional<JointLag>& lag, double period, double position)
    : lags_(lag && lag->delay > 0.0), position_(position) {
  if (!lags_) return;
  const double log_overshoot = lag->overshoot > 0.0 ? math::log(lag->overshoot) : 0.0;
  const double zeta =
      lag->overshoot > 0.0 ? -log_overshoot / std::sqrt(kPi * kPi + log_overshoot * log_overshoot) : 1.0;
  const double omega = 2.0 * zeta / lag->delay;
  const double decay = math::exp(-zeta * omega * period);
  const double rate = omega * std::sqrt(std::max(0.0, 1.0 - zeta * zeta));
  const double cosine = math::cos(rate * period);
  const double sine = rate > 0.0 ? math::sin(rate * period) / rate : period;  // sin(rate * period) / rate
  from_deviation_[0] = decay * (cosine + zeta * omega * sine);
  from_deviation_[1] = -decay * omega * omega * sine;
  from_velocity_[0] = decay * sine;
  from_velocity_[1] = decay * (cosine - zeta * omega * sine);
}

void SimulatedAxis::follow(double set_point) {
  if (!lags_) {
    position_ = set_point;
    return;
  }
  const double deviation = position_ - set_point;
  position_ = set_point + from_deviation_[0] * deviation + from_velocity_[0] * velocity_;
  velocity_ = from_deviation_[1] * deviation + from_velocity_[1] * velocity_;
}

double contact_height(const Scene& scene, const Effects& effects, double x, double y) {
  return touch_height(effects, scene.highest(), [&](double dx, double dy) { return scene.height(x + dx, y + dy); });
}

double contact_along(const Scene& scene, const Effects& effects, const Line& line) {
  return touch_distance(effects, line, [&](const Line& beside) {
    return std::min(scene.first_intersection(beside), distance_down_to(scene.desk(), beside));
  });
}

double desk_along(const Scene& scene, const Effects& effects, const Line& line) {
  return touch_distance(effects, line, [&](const Line& beside) { return distance_down_to(scene.desk(), beside); });
}

double foreign_object_height(const ForeignObjects& effect, std::uint64_t seed, double x, double y) {
  const auto column = static_cast<std::int64_t>(std::floor(x / effect.size));
  const auto row = static_cast<std::int64_t>(std::floor(y / effect.size));
  constexpr std::int64_t kColumns = 1 << 20;  // more than the number of columns in any area
  Random random(seed, "simulator/outlier", static_cast<std::uint64_t>(row * kColumns + column));
  return random.uniform() < effect.probability ? effect.height * random.uniform() : 0.0;
}

ContactModel::ContactModel(const Effects& effects, double surface, bool desk, double hover, double threshold,
                           Random random)
    : surface_(surface), hover_(hover), stiffness_(kRigidArm), jerk_(kJerk * threshold), normal_(random) {
  if (effects.force_noise) noise_ = effects.force_noise->deviation;
  if (effects.stiffness) {
    const Stiffness& stiffness = *effects.stiffness;
    give_ = 1.0 / (desk && stiffness.desk ? *stiffness.desk : stiffness.object);
    stiffness_ = 1.0 / (give_ + (stiffness.arm ? 1.0 / *stiffness.arm : 0.0));
  }
  if (effects.force_drift) drift_ = effects.force_drift->per_metre * normal_();
  if (effects.missed_contacts) blind_ = normal_.uniform().uniform() < effects.missed_contacts->probability;
  if (effects.false_contacts && normal_.uniform().uniform() < effects.false_contacts->probability)
    jerk_at_ = surface + (hover - surface) * normal_.uniform().uniform();
  if (effects.latency) late_ = effects.latency->deviation * std::abs(normal_()) / tapping::GuardedTap::kPeriod;
}

/// Returns the measured force, which is the true force `late_` periods ago, interpolated linearly.
double ContactModel::delayed(double force) {
  if (late_ <= 0.0) return force;
  forces_.push_back(force);
  const double at = static_cast<double>(forces_.size() - 1) - late_;
  if (at <= 0.0) return forces_.front();
  const auto before = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(before);
  return share > 0.0 ? (1.0 - share) * forces_[before] + share * forces_[before + 1] : forces_[before];
}

tapping::Sample ContactModel::measure(double position) {
  const double pressed = std::max(0.0, surface_ - position);
  const double contact = stiffness_ * pressed;
  force_ = contact;
  peak_ = std::max(peak_, contact);
  tapping::Sample out{pressed > 0.0 ? surface_ - contact * give_ : position, delayed(blind_ ? 0.0 : contact)};
  out.force += drift_ * (hover_ - position);
  if (noise_ > 0.0) out.force += noise_ * normal_();
  if (position < jerk_at_ && jerk_left_ > 0) {
    out.force += jerk_;
    --jerk_left_;
  }
  return out;
}

}  // namespace palpate::backends
