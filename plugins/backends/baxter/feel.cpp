// SPDX-License-Identifier: MIT
// What Tapper makes of the force that the robot tells.
#include "baxter/readings.hpp"
#include "baxter/tapper.hpp"
#include "tapping/words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpate::baxter {
namespace {

using tapping::newtons;

constexpr std::size_t kForceSamples = 25;  ///< new ones, for the force at rest
constexpr double kForcePatience = 1.0;     ///< s in which they must have come
constexpr int kTold = 3;                   ///< taps of a run for which that is noted
constexpr double kMostMoving = 0.8;        ///< of the threshold: more may be a contact that begins
constexpr double kLeastMoved = 2.5;        ///< N that the zero may move, whatever the threshold: noise makes 0.4

}  // namespace

std::string Tapper::learnt_sign() const {
  if (options_.sign() != BaxterOptions::ForceSign::learn || sign_ == 0.0) return {};
  return sign_ > 0.0 ? "positive" : "negative";
}

/// From the latest contact, once it is believed and is where it should be.
void Tapper::learn_sign() {
  if (sign_ != 0.0) return;
  sign_ = shown_sign_;
  note_("force_sign: when something presses the tool upwards, the force along z " +
        std::string(sign_ > 0.0 ? "rises: positive" : "falls: negative"));
}

/// What the force reads beside while the arm comes down in the air is no contact: from now on it counts as zero then.
void Tapper::learn_moving(double difference) {
  const bool much = std::abs(difference) >= kMostMoving * options_.motion.threshold;
  moving_ = much ? 0.0 : difference;
  if (told_ >= kTold) return;
  ++told_;
  note_("coming down in the air the force along z reads " + newtons(difference) + " beside that at rest" +
        (much
             ? ", too much to be taken for its zero: calibrate the robot (rosrun baxter_tools tare.py) or take a lower "
               "motion.speed"
             : ": taken for its zero while the arm comes down, from the next tap on"));
}

/// Whether two zeros, felt at rest before and after a tap, are the same. Sideways the robot's estimate is at its worst.
bool Tapper::believed(const Eigen::Vector3d& before, const Eigen::Vector3d& after, double threshold) const {
  const Eigen::Vector3d moved = after - before;
  return std::abs(moved.z()) < std::max(kLeastMoved, 0.5 * threshold) && moved.head<2>().norm() < options_.force_stop;
}

/// The median of a few new readings, while the arm is where it is sent: one of them may be far off.
Eigen::Vector3d Tapper::force_at_rest(const Joints& joints) {
  std::vector<Eigen::Vector3d> readings;
  const double patience = seen_.now + kForcePatience;
  while (readings.size() < kForceSamples && seen_.now < patience) {
    step(joints);
    if (watch_.fresh()) readings.push_back(seen_.endpoint->force);
  }
  if (readings.size() < kForceSamples) {
    throw Fault{"endpoint_state comes too seldom for the force at rest", Fault::Then::hold};
  }
  return median(std::move(readings));
}

}  // namespace palpate::baxter
