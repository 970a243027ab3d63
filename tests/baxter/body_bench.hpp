// SPDX-License-Identifier: MIT
// The simulated robot's body in this process under direct control, for tests of the body and of its users.
#pragma once

#include "baxter/body_robot.hpp"
#include "scene/scene_options.hpp"
#include "support/filled.hpp"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

namespace palpate::test {

/// Objects and effects of configs/scene/object_i_arm.yaml, as YAML.
constexpr const char* kObjectI =
    "[{type: wave, length: 16 cm, width: 6 cm, height: 9 cm, amplitude: 2 cm, period: 8 cm, at: [11.5 cm, 11.5 cm], "
    "rotation: 90 deg}]";
constexpr const char* kBare = "[]";
constexpr const char* kQuiet = "{stiffness: {object: 1500 N/m}, force_noise: {deviation: 0 N}}";
constexpr const char* kLikeBaxter =
    "{stiffness: {object: 1500 N/m}, joint_lag: {delay: 350 ms}, force_noise: {deviation: 1.5 N}}";

/// Returns tool and scene pose of configs/backend/fake_baxter.yaml.
inline fake_baxter::BodyOptions fake_options() { return baxter::test::body_options(baxter::test::fake_options()); }

/// Returns a desk of 23 cm by 23 cm with `objects` (a YAML list) and `effects` (a YAML map).
inline std::unique_ptr<const Scene> scene_of(const std::string& objects, const std::string& effects,
                                             std::uint64_t seed = 1) {
  const std::string area = "area: {width: 23 cm, depth: 23 cm}";
  const auto options = filled<SceneOptions>("{" + area + ", objects: " + objects + ", effects: " + effects + "}");
  return build_scene(options, seed, shared_host());
}

class BodyBench {
 public:
  using Change = std::function<void(fake_baxter::BodyOptions&)>;

  /// Creates a robot over scene_of(objects, effects).
  explicit BodyBench(const std::string& objects = kObjectI, const std::string& effects = kLikeBaxter,
                     const Change& change = nullptr)
      : BodyBench(objects, effects, changed(change)) {}
  BodyBench(const std::string& objects, const std::string& effects, const fake_baxter::BodyOptions& options)
      : scene(scene_of(objects, effects, options.seed)),
        tool(Eigen::Vector3d(options.tool.tip)),
        frame(options.scene_pose.frame()),
        body(*scene, options),
        target(body.joints()) {}

  /// Injects a fault, written as on the command line.
  void inject(const std::string& fault, const std::string& at = "start") {
    body.inject(fake_baxter::parse_fault(fault), fake_baxter::parse_trigger(at));
  }
  baxter::StateReading state() const { return *body.messages().state; }
  Eigen::Vector3d force() const { return body.messages().endpoint->force; }
  bool reflex() const { return body.mode() == fake_baxter::Body::Mode::reflex; }

  /// Simulates `seconds` with set-points at `target`. Outside of hold() no set-points are sent.
  void hold(double seconds) {
    periods(seconds, [&] { body.command(target); });
  }
  void wait(double seconds) {
    periods(seconds, [] {});
  }

  /// Moves the set-point along a line to a position of the scene (metres, m/s), until `stop` is true.
  template <class Stop>
  void lead(const Eigen::Vector3d& goal, double speed, const Stop& stop) {
    baxter::Pose pose = tool.tip(target);
    const Eigen::Vector3d end = frame * goal;
    while (pose.position != end && !stop()) {
      const Eigen::Vector3d way = end - pose.position;
      const double step = speed * fake_baxter::Body::kPeriod;
      aim(way.norm() <= step ? end : Eigen::Vector3d(pose.position + step * way.normalized()), pose);
      body.command(target);
      body.step();
    }
  }
  void lead(const Eigen::Vector3d& goal, double speed) {
    lead(goal, speed, [] { return false; });
  }

  /// Moves the set-point to `goal` at once.
  void jump(const Eigen::Vector3d& goal) {
    baxter::Pose pose = tool.tip(target);
    aim(frame * goal, pose);
  }

  std::unique_ptr<const Scene> scene;
  baxter::ArmKinematics tool;
  Eigen::Isometry3d frame;  ///< of the scene's frame in `base`
  fake_baxter::Body body;
  baxter::Joints target;

 private:
  static fake_baxter::BodyOptions changed(const Change& change) {
    fake_baxter::BodyOptions out = fake_options();
    if (change) change(out);
    return out;
  }

  void aim(const Eigen::Vector3d& in_base, baxter::Pose& pose) {
    pose.position = in_base;
    const auto found = tool.solve(pose, target);
    if (!found) throw std::runtime_error("out of reach");
    target = *found;
  }

  template <class Act>
  void periods(double seconds, const Act& act) {
    for (long i = std::lround(seconds / fake_baxter::Body::kPeriod); i > 0; --i) {
      act();
      body.step();
    }
  }
};

}  // namespace palpate::test
