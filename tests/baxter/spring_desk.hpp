// SPDX-License-Identifier: MIT
// The driver and an arm with springs over a bare desk of a given stiffness.
#pragma once

#include "baxter/body_bench.hpp"
#include "baxter/tapper_bench.hpp"

#include <fmt/format.h>

namespace palpate::baxter::test {

/// Makes taps and records their forces and times.
class SpringDesk {
 public:
  explicit SpringDesk(double stiffness, const BaxterOptions& options = fake_options(), double friction = 0.0)
      : scene_(palpate::test::scene_of("[]", fmt::format("{{stiffness: {{object: {} N/m}}}}", stiffness))),
        robot(*scene_, body(options, friction)),
        tapper(options, *scene_, robot, nullptr, [this](const std::string& note) { notes += note + "\n"; }) {
    robot.every_period = [this] {
      const double presses = robot.body.pressing();
      peak = std::max(peak, presses);
      pull = std::max(pull, -presses);
      lowest = std::min(lowest, robot.body.tip().z());
      if (presses > 0.0 && !touched) touched = robot.body.now();
      const bool reflex = robot.body.mode() == fake_baxter::Body::Mode::reflex;
      reflexes += reflex && !in_reflex_ ? 1 : 0;
      in_reflex_ = reflex;
    };
  }

  tapping::HeightResult tap(const Target& place) {
    TapRequest request;
    request.number = ++taps_;
    request.line = line_from_above(place);
    touched.reset();
    peak = 0.0;
    lowest = 1.0;
    return tapper.tap(request);
  }
  /// Taps at a new position.
  tapping::HeightResult tap() { return tap({0.06 + 0.03 * taps_, 0.05}); }
  void inject(const std::string& fault) { robot.body.inject(fake_baxter::parse_fault(fault)); }
  void wait(double seconds) { robot.wait_until(robot.body.now() + seconds); }

 private:
  static BodyOptions body(const BaxterOptions& options, double friction) {
    BodyOptions out = body_options(options);
    out.mechanics = {fake_baxter::MechanicsOptions::Type::springs, friction, 1e-3};
    return out;
  }

  std::unique_ptr<const Scene> scene_;
  int taps_ = 0;
  bool in_reflex_ = false;

 public:
  std::string notes;
  BodyRobot robot;
  Tapper tapper;
  double peak = 0.0;              ///< N, largest force in this tap
  double lowest = 1.0;            ///< m, lowest tip in this tap
  std::optional<double> touched;  ///< s, first contact force in this tap
  double pull = 0.0;              ///< N, largest force so far that held the tool
  int reflexes = 0;               ///< number of the firmware's reflexes so far
};

}  // namespace palpate::baxter::test
