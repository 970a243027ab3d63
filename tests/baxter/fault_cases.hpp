// SPDX-License-Identifier: MIT
// Faults in a tap and their expected consequences, for tests in one process and over ROS.
#pragma once

#include <ostream>
#include <string>

namespace palpate::test {

struct FaultCase {
  const char* name;
  const char* fault;    ///< as on fake_baxter's command line
  const char* reason;   ///< expected reason of the tap
  bool raised = false;  ///< whether the arm rises to the height of travel
  bool ends_run = true;
};

inline void PrintTo(const FaultCase& trouble, std::ostream* out) { *out << trouble.fault; }

inline std::string name_of(const FaultCase& trouble) { return trouble.name; }

inline constexpr FaultCase kFaultCases[] = {
    {"EmergencyStop", "estop", "the emergency stop is pressed"},
    {"ErrorFlag", "error", "the robot reports an error and is disabled"},
    {"Squish", "squish", "the arm's own reflex stopped it", true},
    {"FrozenEndpoint", "freeze_endpoint", "exactly the same force"},
    {"KilledEndpoint", "kill_endpoint", "endpoint_state of the left arm did not arrive"},
    {"KilledJoints", "kill_joints", "joint_states of the left arm did not arrive"},
    {"KilledState", "kill_state", "/robot/state did not arrive"},
    {"StaleStamps", "stale_stamps", "its data are stale"},
    {"SecondState", "second_sender=state", "/robot/state comes from more than one node"},
    {"SecondEndpoint", "second_sender=endpoint", "endpoint_state of the left arm comes from more than one node"},
    {"SecondCollision", "second_sender=collision",
     "collision_detection_state of the left arm comes from more than one"},
    {"SlowForce", "slow_force=10", "with a new force only"},
    {"LowSpeedRatio", "speed_ratio=0.05", "has set it to 0.05, too low for the arm to follow"},
    {"ForceIsNoNumber", "nan_wrench", "not a number"},
    {"ForceIsZero", "zero_wrench", "a force of exactly zero"},
    {"BiasUp", "bias=8", "its zero moved during the tap", true, false},
    {"BiasFarUp", "bias=20", "more than force_stop allows", true},
    {"BiasDown", "bias=-9", "the force fell by more than the threshold", true},
    {"DroppedCommands", "drop_commands=5", "the arm does not follow"},
    {"JumpOfTheJoints", "jump_joints=0.3", "/robot/joint_states jumped by"},
    {"FrozenClock", "freeze_clock", "the clock of the robot's network has stopped"},
};

}  // namespace palpate::test
