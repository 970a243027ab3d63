// SPDX-License-Identifier: MIT
// The driver and a simulated robot in this process, over the paper's object I.
#pragma once

#include "baxter/body_robot.hpp"
#include "baxter/tapper.hpp"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::baxter::test {

using palpate::test::wave_scene;

inline constexpr double kHover = 0.135;
inline const Target kOnObject{0.115, 0.115};
inline const Target kOnDesk{0.03, 0.03};

template <class Options>
using Change = std::function<void(Options&)>;

/// Returns fake_options() with a change.
inline BaxterOptions with(const Change<BaxterOptions>& change) {
  BaxterOptions out = fake_options();
  change(out);
  return out;
}

/// Adds a calibration tap at a position.
inline void calibrate(BaxterOptions& options, double x, double y) {
  options.calibration.emplace();
  options.calibration->at[0] = x;
  options.calibration->at[1] = y;
}

/// Returns options with the robot's inverse kinematics.
inline BaxterOptions asking() {
  return with([](BaxterOptions& o) { o.inverse_kinematics = BaxterOptions::InverseKinematics::robot; });
}

/// Inverse kinematics service that does not answer.
inline std::optional<Joints> silent_service(const Pose&, const Joints&) {
  throw Error("", "IKService did not answer", {}, Error::Kind::run);
}

/// The driver with `options` and a robot with fake_options() and `change`, both observed by the test.
class TapperBench {
 public:
  explicit TapperBench(const BaxterOptions& options = fake_options(), const Change<BodyOptions>& change = nullptr)
      : robot(wave_scene(), changed(change)),
        tapper_(options, wave_scene(), robot, &interrupted,
                [this](const std::string& line) { notes.push_back(line); }) {}

  tapping::HeightResult tap(const Target& place, int motion = 0) {
    TapRequest request = this->request(place, ++taps_);
    request.motion = motion;
    previous_ = request.line;
    return tapper_.tap(request);
  }
  /// Taps and expects a contact whose height is within `within` of the scene's.
  tapping::HeightResult touch(const Target& place, double within = 0.002) {
    const tapping::HeightResult out = tap(place);
    EXPECT_EQ(out.outcome, Outcome::contact) << out.reason;
    EXPECT_NEAR(out.height, wave_scene().height(place.x, place.y), within);
    return out;
  }
  std::vector<std::string> describe(const Target& place) { return tapper_.describe(request(place, taps_ + 1)); }
  void check() { tapper_.check(); }
  std::string learnt_sign() const { return tapper_.learnt_sign(); }
  double tip() const { return robot.body.tip().z(); }
  /// Moves the arm for five seconds, as another program or a hand would.
  void lead_away(const Joints& joints) {
    for (int i = 0; i < 500; ++i) {
      robot.body.command(joints);
      robot.wait_until(robot.body.now() + 0.01);
    }
  }

  std::atomic<bool> interrupted{false};
  std::vector<std::string> notes;

 private:
  static BodyOptions changed(const Change<BodyOptions>& change) {
    BodyOptions out = body_options(fake_options());
    if (change) change(out);
    return out;
  }
  TapRequest request(const Target& place, int number) const {
    TapRequest out;
    out.number = number;
    out.line = line_from_above(place);
    out.previous = previous_;
    return out;
  }

 public:
  BodyRobot robot;

 private:
  Tapper tapper_;
  int taps_ = 0;
  std::optional<TapLine> previous_;
};

}  // namespace palpate::baxter::test
