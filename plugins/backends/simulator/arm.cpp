// SPDX-License-Identifier: MIT
#include "simulator/arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::backends {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Where no stiffness is modelled the object is rigid and the arm nearly so: 10 N are reached after 0.1 mm of
/// set-point.
constexpr double kRigidArm = 1e5;
/// A jerk feels like twice the threshold, for 50 ms.
constexpr double kJerk = 2.0;
constexpr int kJerkPeriods = 5;

}  // namespace

// With deviation d = position - set-point: d'' + 2 zeta omega d' + omega^2 d = 0. On a ramp of speed v the arm trails
// by 2 zeta / omega * v, which is delay * v; a step is overshot by exp(-pi zeta / sqrt(1 - zeta^2)) of its height.
Arm::Arm(const std::optional<JointLag>& lag, double period, double position)
    : lags_(lag && lag->delay > 0.0), position_(position) {
  if (!lags_) return;
  const double log_overshoot = lag->overshoot > 0.0 ? std::log(lag->overshoot) : 0.0;
  const double zeta =
      lag->overshoot > 0.0 ? -log_overshoot / std::sqrt(kPi * kPi + log_overshoot * log_overshoot) : 1.0;
  const double omega = 2.0 * zeta / lag->delay;
  const double decay = std::exp(-zeta * omega * period);
  const double rate = omega * std::sqrt(std::max(0.0, 1.0 - zeta * zeta));
  const double cosine = std::cos(rate * period);
  const double sine = rate > 0.0 ? std::sin(rate * period) / rate : period;  // sin(rate t) / rate
  from_deviation_[0] = decay * (cosine + zeta * omega * sine);
  from_deviation_[1] = -decay * omega * omega * sine;
  from_velocity_[0] = decay * sine;
  from_velocity_[1] = decay * (cosine - zeta * omega * sine);
}

void Arm::follow(double set_point) {
  if (!lags_) {
    position_ = set_point;
    return;
  }
  const double deviation = position_ - set_point;
  position_ = set_point + from_deviation_[0] * deviation + from_velocity_[0] * velocity_;
  velocity_ = from_deviation_[1] * deviation + from_velocity_[1] * velocity_;
}

Touch::Touch(const Effects& effects, double surface, double hover, double threshold, Random random)
    : surface_(surface),
      hover_(hover),
      stiffness_(kRigidArm),
      give_(0.0),
      noise_(effects.force_noise ? effects.force_noise->deviation : 0.0),
      drift_(0.0),
      blind_(false),
      jerk_at_(-std::numeric_limits<double>::infinity()),
      jerk_(kJerk * threshold),
      jerk_left_(kJerkPeriods),
      normal_(random) {
  if (effects.stiffness) {
    const Stiffness& stiffness = *effects.stiffness;
    give_ = 1.0 / stiffness.object;
    stiffness_ = 1.0 / (give_ + (stiffness.arm ? 1.0 / *stiffness.arm : 0.0));
  }
  if (effects.force_drift) drift_ = effects.force_drift->per_metre * normal_();
  if (effects.missed_contacts) blind_ = normal_.uniform().uniform() < effects.missed_contacts->probability;
  if (effects.false_contacts && normal_.uniform().uniform() < effects.false_contacts->probability) {
    jerk_at_ = surface + (hover - surface) * normal_.uniform().uniform();
  }
}

Touch::Felt Touch::feel(double position) {
  const double pressed = std::max(0.0, surface_ - position);
  const double contact = stiffness_ * pressed;
  Felt out{pressed > 0.0 ? surface_ - contact * give_ : position, blind_ ? 0.0 : contact};
  out.force += drift_ * (hover_ - position);
  if (noise_ > 0.0) out.force += noise_ * normal_();
  if (position < jerk_at_ && jerk_left_ > 0) {
    out.force += jerk_;
    --jerk_left_;
  }
  return out;
}

}  // namespace palpate::backends
