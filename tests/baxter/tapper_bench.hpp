// SPDX-License-Identifier: MIT
// The driver and a robot in the same process, over the paper's object I.
#pragma once

#include "baxter/body_robot.hpp"
#include "baxter/tapper.hpp"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::baxter::test {

using palpate::test::wave_scene;

inline constexpr double kHover = 0.135;
inline const Target kOnObject{0.115, 0.115};
inline const Target kOnDesk{0.03, 0.03};

/// The driver taps, the test looks on.
class TapperBench {
 public:
  explicit TapperBench(const BaxterOptions& options = fake_options(), const BaxterOptions& truth = fake_options(),
                       const std::function<void(BodyOptions&)>& change = nullptr)
      : options_(options),
        robot(wave_scene(), changed(truth, change)),
        tapper_(options, wave_scene(), robot, &interrupted,
                [this](const std::string& line) { notes.push_back(line); }) {}

  Contact tap(const Target& place) {
    const TapRequest request{++taps_, place, previous_, std::nullopt};
    previous_ = place;
    return tapper_.tap(request);
  }
  std::vector<std::string> describe(const Target& place) {
    return tapper_.describe({taps_ + 1, place, previous_, std::nullopt});
  }
  void check() { tapper_.check(); }
  std::string learnt_sign() const { return tapper_.learnt_sign(); }
  double tip() const { return robot.body.tip().z(); }

  std::atomic<bool> interrupted{false};
  std::vector<std::string> notes;

 private:
  static BodyOptions changed(const BaxterOptions& truth, const std::function<void(BodyOptions&)>& change) {
    BodyOptions out = body_options(truth);
    if (change) change(out);
    return out;
  }
  BaxterOptions options_;

 public:
  BodyRobot robot;

 private:
  Tapper tapper_;
  int taps_ = 0;
  std::optional<Target> previous_;
};

}  // namespace palpate::baxter::test
