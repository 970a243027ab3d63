// SPDX-License-Identifier: MIT
#include "fake_baxter/body.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cmath>

namespace palpate::fake_baxter {
namespace {

constexpr double kForceNoise = 1.5;       // N, where it has no noise
constexpr double kLeastNoise = 0.01;      // N: a real sensor never says the same twice
constexpr double kBias = 2.0;             // N, standard deviation of the bias
constexpr double kBiasByJoints = 2.0;     // N/rad, of how it depends on each joint
constexpr double kTuckedShoulder = -1.6;  // rad: with left_s1 below it the robot refuses to be enabled
constexpr double kAbove = 0.03;           // m, of the start
constexpr double kAvoidanceRate = 10.0;   // Hz; not known of a real one
constexpr double kSlack = 1e-9;           // of times that are sums of periods, s

/// Greatest speed of each joint, rad/s.
Joints greatest_speed() { return (Joints() << 1.5, 1.5, 1.5, 1.5, 4.0, 4.0, 4.0).finished(); }

/// Whether a stream of this rate, Hz, has a message in this period.
bool due(long period, double rate) {
  const auto so_far = [&](long periods) {
    return std::floor(static_cast<double>(periods) * Body::kPeriod * rate + kSlack);
  };
  return period == 0 || so_far(period) > so_far(period - 1);
}

/// Straight down, with the hand turned about the vertical as in the untucked posture.
Eigen::Quaterniond straight_down(const baxter::Arm& arm) {
  const Eigen::Matrix3d untucked_hand = arm.tip(untucked()).rotation.toRotationMatrix();
  Eigen::Vector3d x = untucked_hand.col(0);
  x.z() = 0.0;
  x.normalize();
  const Eigen::Vector3d z(0.0, 0.0, -1.0);
  Eigen::Matrix3d rotation;
  rotation << x, z.cross(x), z;
  return Eigen::Quaterniond(rotation);
}

}  // namespace

const Joints& untucked() {
  static const Joints joints = (Joints() << -0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.50).finished();
  return joints;
}

const Joints& tucked() {
  static const Joints joints = (Joints() << -1.0, -2.174, 3.0, 2.55, 0.0, 0.01, 0.0).finished();
  return joints;
}

Body::Body(const Scene& scene, const BodyOptions& options)
    : scene_(scene),
      ground_(scene, options.place),
      tool_(Eigen::Vector3d(options.tool.tip)),
      gripper_({0.0, 0.0, options.tool.gripper}),
      seed_(options.seed),
      begin_(options.begin),
      mechanics_(make_mechanics(options.mechanics, ground_, Eigen::Vector3d(options.tool.tip))),
      noise_(kForceNoise),
      normal_(Random(options.seed, "fake_baxter/noise")),
      force_faults_(options.seed),
      timeout_(options.command_timeout),
      speed_ratio_(options.speed_ratio) {
  const Effects& effects = scene.effects();
  if (effects.force_noise) noise_ = std::max(kLeastNoise, effects.force_noise->deviation);
  backends::Normal bias(Random(options.seed, "fake_baxter/bias"));
  for (double& one : bias_.reshaped()) one = kBias * bias();
  for (double& one : bias_by_joints_.reshaped()) one = kBiasByJoints * bias();

  target_ = start_joints(options);
  mechanics_->put(target_);
  hold(true);
  if (options.start == Start::tucked && !options.start_at) assembly_ = Assembly(false);
  measure();
}

Joints Body::start_joints(const BodyOptions& options) const {
  if (!options.start_at && options.start == Start::untucked) return untucked();
  if (!options.start_at && options.start == Start::tucked) return tucked();
  const Area area = scene_.area();
  Eigen::Vector3d at(area.width / 2, area.depth / 2, scene_.desk() + options.hover + kAbove);
  if (options.start == Start::low) at = {kAbove, kAbove, scene_.desk() + kAbove};
  if (options.start_at) at = *options.start_at;
  baxter::Pose pose;
  pose.position = ground_.in_base(at);
  pose.rotation = straight_down(tool_);
  const std::optional<Joints> found = tool_.solve(pose, untucked());
  if (!found) throw Error("--start", "the arm cannot reach where it should start", "move the scene by backend.place");
  return *found;
}

Eigen::Vector3d Body::in_scene(const Joints& joints) const { return ground_.in_scene(tool_.tip(joints).position); }

double Body::now() const { return begin_ + static_cast<double>(periods_) * kPeriod; }

void Body::command(const Joints& target) {
  ++commands_;
  if (!target.allFinite() || active(FaultKind::drop_commands) != nullptr) return;
  target_ = target.cwiseMax(baxter::lower_limits()).cwiseMin(baxter::upper_limits());
  commanded_ = now();
}

void Body::set_command_timeout(double seconds) {
  if (std::isfinite(seconds)) timeout_ = seconds;
}

void Body::set_speed_ratio(double ratio) {
  if (std::isfinite(ratio)) speed_ratio_ = std::clamp(ratio, 0.0, 1.0);
}

void Body::enable(bool wanted) {
  const bool refused = joints()(1) < kTuckedShoulder || active(FaultKind::tucked) != nullptr;
  assembly_.enable(wanted, refused);
}

void Body::inject(const Fault& fault, const Trigger& trigger) {
  faults_.push_back({fault, trigger, 0, {}});
  if (trigger.descent == 0) begin(faults_.back());
}

const Fault* Body::active(FaultKind kind) const {
  for (const Armed& one : faults_) {
    if (one.fault.kind != kind || !one.since) continue;
    const bool passes = kind == FaultKind::drop_commands || kind == FaultKind::stall;
    if (passes && now() >= *one.since + one.fault.amount - kSlack) continue;
    return &one.fault;
  }
  return nullptr;
}

bool Body::faulty() const {
  return std::any_of(faults_.begin(), faults_.end(), [](const Armed& one) { return one.since.has_value(); });
}

void Body::begin(Armed& armed) {
  armed.since = now();
  switch (armed.fault.kind) {
    case FaultKind::estop:
      assembly_.press();
      break;
    case FaultKind::stop:
      assembly_.stop();
      break;
    case FaultKind::error:
      assembly_.fail();
      break;
    case FaultKind::complaint:
      assembly_.complain();
      break;
    case FaultKind::squish:
      held_until_ = now() + kHeld;
      hold(false);
      break;
    case FaultKind::disabled:
      assembly_.enable(false, false);
      break;
    case FaultKind::speed_ratio:
      set_speed_ratio(armed.fault.amount);
      break;
    case FaultKind::command_timeout:
      set_command_timeout(armed.fault.amount);
      break;
    case FaultKind::tucked:
      assembly_.enable(false, true);
      target_ = tucked();
      mechanics_->put(target_);
      hold(true);
      measure();
      break;
    default:
      break;
  }
}

void Body::watch_faults(double height_before) {
  const double height = tip().z();
  for (Armed& one : faults_) {
    if (one.since) {
      const bool pressed = assembly_.state().estop_button == Assembly::State::Button::pressed;
      const bool over = now() >= *one.since + one.fault.amount;
      if (one.fault.kind == FaultKind::estop && pressed && over) assembly_.release();
      continue;
    }
    const double mark = scene_.desk() + one.trigger.height;
    if (height_before >= mark && height < mark && ++one.descents == one.trigger.descent) begin(one);
  }
}

Body::Mode Body::choose_mode() const {
  const Assembly::State& state = assembly_.state();
  if (!state.enabled) return state.stopped ? Mode::stopped : Mode::disabled;
  if (now() < held_until_ - kSlack) return Mode::reflex;
  return now() - commanded_ > timeout_ + kSlack ? Mode::timed_out : Mode::following;
}

/// The arm stays where it is: at once by the brakes, else as its joints come to rest there.
void Body::hold(bool brakes) {
  reference_ = mechanics_->holding();
  if (brakes) mechanics_->brake();
}

void Body::follow() {
  if (mode_ == Mode::following) {
    const Joints most = kPeriod * speed_ratio_ * greatest_speed();
    reference_ += (target_ - reference_).cwiseMax(-most).cwiseMin(most);
  }
  mechanics_->advance(reference_);
}

/// An arm that is left pressing is held again and again, and let go in between for as long as it takes to feel that.
void Body::feel_reflex() {
  if (now() < held_until_ + kLetGo - kSlack) return;
  if (!assembly_.state().enabled || pressing() <= kReflex) return;
  held_until_ = now() + kHeld;
  mode_ = Mode::reflex;
  hold(false);
}

void Body::measure() {
  const baxter::Pose pose = gripper_.tip(joints());
  Eigen::Vector3d force = bias_ + bias_by_joints_ * (joints() - untucked()) - arm().felt;
  for (double& one : force.reshaped()) one += noise_ * normal_();
  force = force_faults_.spoilt(force, tool_.jacobian(joints()) * arm().velocity,
                               [&](FaultKind kind) { return active(kind); });
  if (active(FaultKind::freeze_endpoint) != nullptr && periods_ > 0) return;
  endpoint_speed_ = (pose.position - endpoint_.pose.position) / kPeriod;
  if (periods_ == 0) endpoint_speed_.setZero();
  endpoint_.pose = pose;
  endpoint_.force = force;
}

void Body::step() {
  const double height_before = tip().z();
  ++periods_;
  const Mode mode = choose_mode();
  const bool brakes = mode == Mode::stopped || mode == Mode::disabled;
  if (mode != mode_ && mode != Mode::following) hold(brakes);
  mode_ = mode;
  follow();
  feel_reflex();
  watch_faults(height_before);
  measure();
}

Said Body::said() const {
  Said out;
  double stamp = now();
  for (const Armed& one : faults_) {
    if (one.fault.kind == FaultKind::stale_stamps && one.since) stamp = *one.since;
  }
  const Fault* never = active(FaultKind::no_data);
  const auto heard = [&](FaultKind killed, const char* stream) {
    return active(killed) == nullptr && (never == nullptr || never->text != stream);
  };
  const auto stamped = [&](auto reading) {
    reading.received = now();
    reading.stamp = stamp;
    return reading;
  };
  if (heard(FaultKind::kill_joints, "joints")) {
    baxter::JointReading joints;
    joints.position = arm().position;
    if (const Fault* jump = active(FaultKind::jump_joints)) joints.position(1) += jump->amount;
    out.joints = stamped(joints);
    out.speed = arm().velocity;
    out.effort = arm().effort;
  }
  const Fault* slow = active(FaultKind::slow_endpoint);
  if (heard(FaultKind::kill_endpoint, "endpoint") && (slow == nullptr || due(periods_, slow->amount))) {
    out.endpoint = stamped(endpoint_);
    out.tip_speed = endpoint_speed_;
  }
  if (heard(FaultKind::kill_state, "state")) {
    out.state = assembly_.state();
    out.state->received = now();
  }
  if (never == nullptr || never->text != "collision") {
    baxter::CollisionReading collision;
    collision.collision = now() < held_until_ - kSlack;
    out.collision = stamped(collision);
  }
  if ((never == nullptr || never->text != "avoidance") && due(periods_, kAvoidanceRate)) {
    baxter::AvoidanceReading avoidance;
    if (const Fault* avoid = active(FaultKind::avoid)) {
      avoidance.other_arm = avoid->text == "other_arm";
      if (!avoidance.other_arm) avoidance.objects = {avoid->text};
    }
    out.avoidance = stamped(avoidance);
  }
  return out;
}

const char* name_of(Body::Mode mode) {
  switch (mode) {
    case Body::Mode::following:
      return "following";
    case Body::Mode::timed_out:
      return "timed_out";
    case Body::Mode::reflex:
      return "reflex";
    case Body::Mode::stopped:
      return "stopped";
    case Body::Mode::disabled:
      return "disabled";
  }
  return "";
}

}  // namespace palpate::fake_baxter
