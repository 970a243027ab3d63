// SPDX-License-Identifier: MIT
// The simulated robot in this process and without ROS. Its time advances while a caller waits for it.
#pragma once

#include "baxter/bench.hpp"
#include "baxter/robot.hpp"
#include "fake_baxter/body.hpp"
#include "fake_baxter/delivery.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate::baxter::test {

using palpate::fake_baxter::Body;
using palpate::fake_baxter::BodyOptions;
using palpate::fake_baxter::FaultKind;

inline BodyOptions body_options(const BaxterOptions& options) {
  BodyOptions out;
  out.tool = options.tool;
  out.scene_pose = options.scene_pose;
  out.hover = options.motion.hover;
  return out;
}

/// Returns whether all heights within `reach` (m) of a position differ by less than `reach` from its own height. Taps
/// near edges are a separate subject.
inline bool is_even(const Scene& scene, const Target& place, double reach) {
  const double here = scene.height(place.x, place.y);
  for (int side = 0; side < 8; ++side) {
    const Eigen::Vector2d beside = reach * Eigen::Rotation2Dd(side * 0.785398).toRotationMatrix().col(0);
    if (!(std::abs(scene.height(place.x + beside.x(), place.y + beside.y()) - here) < reach)) return false;
  }
  return true;
}

class BodyRobot final : public Robot {
 public:
  BodyRobot(const Scene& scene, const BodyOptions& options)
      : body(scene, options), gripper_({0, 0, options.tool.gripper}) {
    hear();
  }

  Snapshot read() override { return heard_; }

  bool wait_until(double time) override {
    if (body.active(FaultKind::freeze_clock) != nullptr) return false;
    if (late) time += late();
    while (body.now() < time - 1e-9) {
      body.step();
      hear();
      heights.push_back(body.tip().z());
      if (every_period) every_period();
    }
    return true;
  }

  void command(const Joints& target) override {
    commands.push_back(target);
    commanded.push_back(body.now());
    body.command(target);
  }

  void record(const std::string&) override {}

  std::optional<Joints> solve(const Pose& gripper, const Joints& seed) override {
    ++asked;
    if (answer) return answer(gripper, seed);
    return gripper_.solve(gripper, seed);
  }

  Body body;
  std::vector<Joints> commands;
  std::vector<double> commanded;       ///< s, times of the commands
  std::vector<double> heights;         ///< m, height of the tip after each period
  std::function<void()> every_period;  ///< called after each period
  /// Replaces the correct answer of inverse kinematics
  std::function<std::optional<Joints>(const Pose&, const Joints&)> answer;
  std::function<void(Snapshot&)> spoil;  ///< changes a snapshot before it is returned
  std::function<double()> late;          ///< s by which a wait ends late
  int asked = 0;

 private:
  void hear() {
    for (const fake_baxter::RobotMessages& said : delivery_.take(body)) {
      keep(heard_.joints, said.joints);
      keep(heard_.endpoint, said.endpoint);
      keep(heard_.state, said.state);
      keep(heard_.collision, said.collision);
      keep(heard_.avoidance, said.avoidance);
    }
    heard_.now = body.now();
    const auto told = [&](FaultKind kind) {
      const fake_baxter::Fault* fault = body.active(kind);
      return fault != nullptr ? std::optional<ReceivedSetting>({fault->amount, "/other_program"}) : std::nullopt;
    };
    heard_.speed_ratio = told(FaultKind::speed_ratio);
    heard_.command_timeout = told(FaultKind::command_timeout);
    hear_second();
    if (spoil) spoil(heard_);
  }

  /// Records the senders. A second sender follows each message of the robot with one of a robot without forces.
  void hear_second() {
    const fake_baxter::Fault* fault = body.active(FaultKind::second_sender);
    const std::string second = fault != nullptr ? fault->text : "";
    Senders& all = heard_.senders;
    for (const auto& [stream, nodes] : {std::pair{"state", &all.state},
                                        {"endpoint", &all.endpoint},
                                        {"joints", &all.joints},
                                        {"collision", &all.collision},
                                        {"avoidance", &all.avoidance}}) {
      *nodes = {"/realtime_loop"};
      if (second == stream) nodes->push_back("/mock_robot");
    }
    if (second == "endpoint" && heard_.endpoint) {
      EndpointReading calm = *heard_.endpoint;
      calm.force = {0.0, 0.0, 0.1 * std::sin(1000.0 * body.now())};
      count_after(heard_.endpoint, calm);
      heard_.endpoint = calm;
    }
    if (second == "collision" && heard_.collision) heard_.collision->collision = false;
  }

  template <class Reading>
  static void keep(std::optional<Reading>& latest, const std::optional<Reading>& said) {
    if (!said) return;
    Reading next = *said;
    count_after(latest, next);
    latest = next;
  }

  ArmKinematics gripper_;
  fake_baxter::Delivery delivery_;
  Snapshot heard_;
};

}  // namespace palpate::baxter::test
