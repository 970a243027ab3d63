// SPDX-License-Identifier: MIT
// An arm whose joints are springs, as a Baxter's are, over a spring: what a guarded tap of a real arm must cope with.
#pragma once

#include "simulator/arm.hpp"
#include "tapping/guarded_tap.hpp"

#include <algorithm>
#include <functional>
#include <vector>

namespace palpate::test {

struct ElasticArm {
  double surface = 0.0;     ///< m
  double object = 20000.0;  ///< N/m
  double springs = 3800.0;  ///< N/m
  double noise = 0.5;       ///< N
  std::uint64_t seed = 1;
  std::function<double(double)> zero = [](double) { return 0.0; };  ///< N, by the height

  /// One period.
  struct Period {
    double set_point, height, force;  ///< the force is the true one
  };
  std::vector<Period> periods;

  /// Lets a real arm's tap come down until it has ended.
  tapping::GuardedTap tap(const tapping::MotionOptions& motion) {
    using tapping::GuardedTap;
    GuardedTap out(motion, tapping::plan_descent(motion, 0.0, {}), GuardedTap::ArmKind::real);
    backends::GaussianNumbers normal{Random(seed, "elastic arm")};
    backends::SimulatedAxis motors(JointLag{0.35, 0.0}, GuardedTap::kPeriod, motion.hover);
    double set_point = motion.hover;
    while (!out.done()) {
      motors.follow(set_point);
      const double pressed = std::max(0.0, surface - motors.position());
      const double force = pressed / (1.0 / springs + 1.0 / object);
      const double height = motors.position() + force / springs;
      periods.push_back({set_point, height, force});
      set_point = out.next(height, force + zero(height) + noise * normal());
    }
    return out;
  }

  double peak() const {
    double out = 0.0;
    for (const Period& one : periods) out = std::max(out, one.force);
    return out;
  }
};

}  // namespace palpate::test
