// SPDX-License-Identifier: MIT
#include "fake_baxter/body.hpp"

#include "fake_baxter/series_elastic.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::fake_baxter {
namespace {

constexpr double kForceNoise = 1.5;       // N, if the scene has no force noise
constexpr double kLeastNoise = 0.01;      // N: a real sensor never repeats a value exactly
constexpr double kBias = 2.0;             // N, standard deviation of the bias
constexpr double kBiasByJoints = 2.0;     // N/rad, standard deviation of the bias per joint angle
constexpr double kTuckedShoulder = -1.6;  // rad: below this left_s1 the robot cannot be enabled
constexpr double kAbove = 0.03;           // m above the height of travel at the start
constexpr double kMoving = 0.01;          // m/s from which the force of motion is complete
constexpr double kAvoidanceRate = 10.0;   // Hz; unknown for a real robot
constexpr double kSlack = 1e-9;           // s, tolerance for sums of periods

/// Largest speed of each joint, rad/s.
Joints greatest_speed() { return (Joints() << 1.5, 1.5, 1.5, 1.5, 4.0, 4.0, 4.0).finished(); }

/// Returns whether a stream of this rate (Hz) has a message in this period.
bool due(long period, double rate) {
  const auto so_far = [&](long periods) {
    return std::floor(static_cast<double>(periods) * Body::kPeriod * rate + kSlack);
  };
  return period == 0 || so_far(period) > so_far(period - 1);
}

}  // namespace

const Joints& tucked() {
  static const Joints joints = (Joints() << -1.0, -2.174, 3.0, 2.55, 0.0, 0.01, 0.0).finished();
  return joints;
}

Body::Body(const Scene& scene, const BodyOptions& options)
    : scene_(scene),
      scene_frame_(scene, options.scene_pose),
      tool_(Eigen::Vector3d(options.tool.tip)),
      gripper_({0.0, 0.0, options.tool.gripper}),
      seed_(options.seed),
      begin_(options.begin),
      mechanics_(make_mechanics(options.mechanics, scene_frame_, Eigen::Vector3d(options.tool.tip))),
      dynamics_(Eigen::Vector3d(options.tool.tip)),
      noise_(kForceNoise),
      normal_(Random(options.seed, "fake_baxter/noise")),
      spikes_(options.seed, "fake_baxter/spikes"),
      timeout_(options.command_timeout),
      speed_ratio_(options.speed_ratio),
      network_(Random(options.seed, "fake_baxter/commands")) {
  const Effects& effects = scene.effects();
  if (effects.force_noise) noise_ = std::max(kLeastNoise, effects.force_noise->deviation);
  backends::GaussianNumbers bias(Random(options.seed, "fake_baxter/bias"));
  for (double& one : bias_.reshaped()) one = kBias * bias();
  for (double& one : bias_by_joints_.reshaped()) one = kBiasByJoints * bias();

  place(start_joints(options));
}

Joints Body::start_joints(const BodyOptions& options) const {
  const Area area = scene_.area();
  const Eigen::Vector3d above(area.width / 2, area.depth / 2, scene_.desk() + options.hover + kAbove);
  baxter::Pose pose;
  pose.position = scene_frame_.in_base(options.start_at.value_or(above));
  pose.rotation = baxter::straight_down();
  const std::optional<Joints> found = tool_.solve(pose, untucked());
  if (!found)
    throw Error("--start-at", "the arm cannot reach where it should start", "move the scene by backend.scene_pose");
  return *found;
}

Eigen::Vector3d Body::in_scene(const Joints& joints) const { return scene_frame_.in_scene(tool_.tip(joints).position); }

double Body::now() const { return begin_ + static_cast<double>(periods_) * kPeriod; }

void Body::command(const Joints& target) {
  ++commands_;
  const double arrives = network_.arrival(now(), amount(FaultKind::delay), amount(FaultKind::jitter));
  if (arrives <= now() + kSlack) return accept(target);
  sent_.push_back({target, arrives});
}

void Body::accept(const Joints& target) {
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

void Body::release() {
  const auto caught = [](const Armed& one) { return one.fault.kind == FaultKind::caught; };
  faults_.erase(std::remove_if(faults_.begin(), faults_.end(), caught), faults_.end());
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

double Body::amount(FaultKind kind) const {
  const Fault* fault = active(kind);
  return fault != nullptr ? fault->amount : 0.0;
}

bool Body::faulty() const {
  return std::any_of(faults_.begin(), faults_.end(), [](const Armed& one) { return one.since.has_value(); });
}

void Body::begin(Armed& armed) {
  armed.since = now();
  switch (armed.fault.kind) {
    case FaultKind::estop:
      return assembly_.press();
    case FaultKind::stop:
      return assembly_.stop();
    case FaultKind::error:
      return assembly_.fail();
    case FaultKind::complaint:
      return assembly_.complain();
    case FaultKind::squish:
      held_until_ = now() + kHeld;
      return hold(false);
    case FaultKind::disabled:
      return assembly_.enable(false, false);
    case FaultKind::speed_ratio:
      return set_speed_ratio(armed.fault.amount);
    case FaultKind::command_timeout:
      return set_command_timeout(armed.fault.amount);
    case FaultKind::tucked:
      assembly_.enable(false, true);
      return place(tucked());
    default:
      break;
  }
}

/// Moves the arm to `joints` at once.
void Body::place(const Joints& joints) {
  target_ = joints;
  mechanics_->put(joints);
  hold(true);
  apply_caught_tool();
  measure();
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

/// Holds the arm at its position, at once with brakes, else after its joints have come to rest.
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
  apply_caught_tool();
}

/// Simulates a caught tool: a spring at the height of the contact that only pulls. The springs in the joints yield to
/// it immediately, independently of the mechanics.
void Body::apply_caught_tool() {
  arm_ = mechanics_->state();
  const Fault* caught = active(FaultKind::caught);
  if (caught == nullptr) return anchor_.reset();
  if (arm_.pressing > 0.0) anchor_ = tip().z() + arm_.depth;
  if (!anchor_ || tip().z() <= *anchor_) return;
  const Joints lever = dynamics_.jacobian(arm_.position).row(2).transpose();
  const Joints turned = lever.cwiseQuotient(spring_stiffness());  // by each newton
  const double pull = (tip().z() - *anchor_) / (1.0 / caught->amount + lever.dot(turned));
  arm_.position -= pull * turned;
  arm_.effort += pull * lever;
  arm_.felt.z() -= pull;
  arm_.pressing = -pull;
}

/// Simulates the firmware's reflex. While the arm keeps pressing it is held repeatedly, and released in between for the
/// time of a new detection.
void Body::simulate_reflex() {
  if (now() < held_until_ + kLetGo - kSlack) return;
  if (!assembly_.state().enabled || std::abs(pressing()) <= kReflex) return;
  held_until_ = now() + kHeld;
  mode_ = Mode::reflex;
  hold(false);
}

void Body::measure() {
  const baxter::Pose pose = gripper_.tip(joints());
  const Eigen::Vector3d way = pose.position - endpoint_.pose.position;
  endpoint_speed_ = periods_ == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(way / kPeriod);
  Eigen::Vector3d force = bias_ + bias_by_joints_ * (joints() - untucked()) - arm().felt;
  force.z() += amount(FaultKind::force_drift) * (tip().z() - scene_.desk());
  if (const double constant = amount(FaultKind::wrench_filter); constant > 0.0) {
    if (!filtered_) filtered_ = force;
    *filtered_ += (1.0 - std::exp(-kPeriod / constant)) * (force - *filtered_);
    force = *filtered_;
  }
  for (double& one : force.reshaped()) one += noise_ * normal_();
  apply_force_faults(force);
  if (active(FaultKind::freeze_endpoint) != nullptr && periods_ > 0) return;
  endpoint_.pose = pose;
  const Fault* slow = active(FaultKind::slow_force);
  if (slow == nullptr || periods_ % std::lround(slow->amount) == 0) endpoint_.force = force;
}

/// Applies faults to the estimated force.
void Body::apply_force_faults(Eigen::Vector3d& force) {
  if (const Fault* bias = active(FaultKind::bias)) force.z() -= bias->amount;
  if (const Fault* spikes = active(FaultKind::spikes)) {
    if (spikes_.uniform() < spikes->amount) force.z() -= kSpike;
  }
  if (const Fault* moving = active(FaultKind::moving_force)) {
    // Joint friction: during a descent the force seems to press the tool upwards.
    const Eigen::Vector3d way = endpoint_speed_ / std::max(kMoving, endpoint_speed_.norm());
    force += moving->amount * (way + way.z() * Eigen::Vector3d(0.5, -0.3, 0.0));
  }
  if (active(FaultKind::zero_wrench) != nullptr) force.setZero();
  if (active(FaultKind::nan_wrench) != nullptr) force.setConstant(std::numeric_limits<double>::quiet_NaN());
}

void Body::step() {
  const double height_before = tip().z();
  ++periods_;
  for (; !sent_.empty() && sent_.front().arrives <= now() + kSlack; sent_.pop_front()) accept(sent_.front().target);
  const Mode mode = choose_mode();
  const bool brakes = mode == Mode::stopped || mode == Mode::disabled;
  if (mode != mode_ && mode != Mode::following) hold(brakes);
  mode_ = mode;
  follow();
  simulate_reflex();
  watch_faults(height_before);
  measure();
}

RobotMessages Body::messages() const {
  RobotMessages out;
  double stamp = now();
  for (const Armed& one : faults_) {
    if (one.fault.kind == FaultKind::stale_stamps && one.since) stamp = *one.since;
  }
  const Fault* muted = active(FaultKind::no_data);
  const auto is_sent = [&](const char* stream) { return muted == nullptr || muted->text != stream; };
  const auto stamped = [&](auto reading) {
    reading.received = now();
    reading.stamp = stamp;
    return reading;
  };
  if (is_sent("joints") && active(FaultKind::kill_joints) == nullptr) {
    baxter::JointReading joints;
    joints.position = arm().position;
    if (const Fault* jump = active(FaultKind::jump_joints)) joints.position(1) += jump->amount;
    out.joints = stamped(joints);
    out.speed = arm().velocity;
    out.effort = arm().effort;
  }
  const Fault* slow = active(FaultKind::slow_endpoint);
  const double rate = slow != nullptr ? slow->amount : 1.0 / kPeriod;
  if (is_sent("endpoint") && active(FaultKind::kill_endpoint) == nullptr && due(periods_, rate)) {
    out.endpoint = stamped(endpoint_);
    out.tip_speed = endpoint_speed_;
  }
  if (is_sent("state") && active(FaultKind::kill_state) == nullptr) {
    out.state = assembly_.state();
    out.state->received = now();
  }
  if (is_sent("collision")) out.collision = stamped(baxter::CollisionReading{{}, now() < held_until_ - kSlack});
  if (is_sent("avoidance") && due(periods_, kAvoidanceRate)) {
    baxter::AvoidanceReading avoidance;
    const Fault* avoid = active(FaultKind::avoid);
    avoidance.other_arm = avoid != nullptr && avoid->text == "other_arm";
    if (avoid != nullptr && !avoidance.other_arm) avoidance.objects = {avoid->text};
    out.avoidance = stamped(avoidance);
  }
  return out;
}

const char* name_of(Body::Mode mode) {
  constexpr const char* kNames[] = {"following", "timed_out", "reflex", "stopped", "disabled"};
  return kNames[static_cast<int>(mode)];
}

}  // namespace palpate::fake_baxter
