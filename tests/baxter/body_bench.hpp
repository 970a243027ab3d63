// SPDX-License-Identifier: MIT
// The robot's body in this process, led by hand: what tests of it, and of what drives it, start from.
#pragma once

#include "baxter/body_robot.hpp"
#include "scene/scene_options.hpp"
#include "support/filled.hpp"

#include <memory>
#include <stdexcept>
#include <string>

namespace palpate::test {

/// The objects and effects of configs/scene/object_i_arm.yaml, as YAML.
constexpr const char* kObjectI =
    "[{type: wave, length: 16 cm, width: 6 cm, height: 9 cm, amplitude: 2 cm, period: 8 cm, at: [11.5 cm, 11.5 cm], "
    "rotation: 90 deg}]";
constexpr const char* kLikeBaxter =
    "{stiffness: {object: 1500 N/m}, joint_lag: {delay: 350 ms}, force_noise: {deviation: 1.5 N}}";

/// Tool and place of configs/backend/fake_baxter.yaml.
inline fake_baxter::BodyOptions fake_options() { return baxter::test::body_options(baxter::test::fake_options()); }

class BodyBench {
 public:
  /// `objects` is a YAML list, `effects` a YAML map.
  explicit BodyBench(const std::string& objects = kObjectI, const std::string& effects = kLikeBaxter,
                     const fake_baxter::BodyOptions& options = fake_options())
      : scene(build_scene(filled<SceneOptions>("{area: {width: 23 cm, depth: 23 cm}, objects: " + objects +
                                               ", effects: " + effects + "}"),
                          options.seed, shared_host())),
        tool(Eigen::Vector3d(options.tool.tip)),
        place(options.place),
        body(*scene, options),
        target(body.joints()) {}

  /// Lets time pass with set-points at `target`, or without any.
  void hold(double seconds) {
    periods(seconds, [&] { body.command(target); });
  }
  void wait(double seconds) {
    periods(seconds, [] {});
  }

  /// Leads the set-point straight to a place of the scene, metres and m/s, until `stop` holds.
  template <class Stop>
  void lead(const Eigen::Vector3d& goal, double speed, const Stop& stop) {
    baxter::Pose pose = tool.tip(target);
    const Eigen::Vector3d end = in_base(goal);
    while (pose.position != end && !stop()) {
      const Eigen::Vector3d way = end - pose.position;
      const double step = speed * fake_baxter::Body::kPeriod;
      pose.position = way.norm() <= step ? end : Eigen::Vector3d(pose.position + step * way.normalized());
      const auto found = tool.solve(pose, target);
      if (!found) throw std::runtime_error("out of reach");
      target = *found;
      body.command(target);
      body.step();
    }
  }
  void lead(const Eigen::Vector3d& goal, double speed) {
    lead(goal, speed, [] { return false; });
  }

  Eigen::Vector3d in_base(const Eigen::Vector3d& at) const {
    Eigen::Vector3d out;
    out << Eigen::Vector2d(place.corner) + Eigen::Rotation2Dd(place.rotation) * at.head<2>(), place.height + at.z();
    return out;
  }

  std::unique_ptr<const Scene> scene;
  baxter::Arm tool;
  baxter::PlaceOptions place;
  fake_baxter::Body body;
  baxter::Joints target;

 private:
  template <class Act>
  void periods(double seconds, const Act& act) {
    for (long i = std::lround(seconds / fake_baxter::Body::kPeriod); i > 0; --i) {
      act();
      body.step();
    }
  }
};

}  // namespace palpate::test
