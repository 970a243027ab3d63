// SPDX-License-Identifier: MIT
// A simulated arm that taps the scene of the config. Without effects, the result of a tap has a closed form. Effects on
// the tool, the position or the objects change the touched surface. With effects on the motion or the force, the tap is
// simulated period by period.
#pragma once

#include "tapping/height_result.hpp"
#include "tapping/motion.hpp"

#include <palpate/effects.hpp>
#include <palpate/plugin.hpp>

namespace palpate::backends {

struct SimulatorOptions : Options {
  tapping::BackendMotion motion;
  double pace = 0.0;
  void list(Fields& fields) override {
    fields.section(motion, Field("motion", "motion of the arm in a tap"));
    fields.real(pace, Field("pace", "seconds of real time per second of robot time; 0 for the highest speed")
                          .at_least(0)
                          .not_identifying());
  }
};

class Simulator final : public Backend {
 public:
  using Options = SimulatorOptions;

  /// Throws Error if an object reaches the height of travel.
  Simulator(const Options& options, const Context& context);

  TapResult tap(const TapRequest& request) override;
  bool taps_any_line() const override { return true; }
  void reaches(const Candidates& lines, BoolOut out) const override;
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }
  QuantitySet predicts() const override { return tapping::predicts(options_.motion); }
  static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene) {
    return tapping::motions(options.motion, scene.desk());
  }

 private:
  /// A motion and the descent that it plans.
  struct PlannedDescent {
    const tapping::MotionOptions& motion;
    tapping::Descent descent;
  };
  bool reaches(const TapLine& line) const;
  bool beyond_reach(double x, double y) const;
  /// Returns the difference between the true and the requested position, metres. It does not include the height offset.
  Eigen::Vector3d pose_error(const TapRequest& request) const;
  tapping::HeightResult ideal_tap(const PlannedDescent& tap, double surface) const;
  TapResult imperfect_tap(const TapRequest& request, const PlannedDescent& tap, const Scene& scene) const;
  tapping::HeightResult simulated_tap(int number, const PlannedDescent& tap, double surface, bool desk) const;
  TapResult tap_along(const TapRequest& request) const;
  TapResult tap_from_above(const TapRequest& request);
  bool wait(double tap_seconds) const;

  SimulatorOptions options_;
  const Context& context_;
  const Scene& scene_;
  std::unique_ptr<const Scene> pushed_;  ///< scene after the last tap, if taps push objects
  bool perfect_;                         ///< whether the scene has no effects
  bool moves_;                           ///< whether an effect changes the motion or the measured force
};

}  // namespace palpate::backends
