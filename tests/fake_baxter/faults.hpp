// SPDX-License-Identifier: MIT
// What may go wrong with the robot of the tests, and when.
#pragma once

#include <optional>
#include <string>

namespace palpate::fake_baxter {

/// A fault, with the name that it has on the command line. Those marked * hold from the start, whenever they are asked
/// to begin.
enum class FaultKind {
  estop,            ///< somebody presses the emergency stop, and lets go after VALUE seconds (2)
  stop,             ///< a program stops the robot by /robot/set_super_stop
  error,            ///< a joint has a fault: the robot reports an error and stops itself
  complaint,        ///< the robot reports an error of a component, which stops nothing and outlasts a reset
  squish,           ///< the firmware feels a collision, whatever the force
  freeze_endpoint,  ///< endpoint_state goes on with fresh stamps, but pose and force stay the same
  kill_endpoint,    ///< endpoint_state stops
  kill_joints,      ///< joint_states of the arm stop
  kill_state,       ///< /robot/state stops
  stale_stamps,     ///< messages go on, but their stamps stay the same
  second_state,     ///< another node publishes /robot/state, too: a healthy robot's
  nan_wrench,       ///< the force is not a number
  zero_wrench,      ///< the force is exactly zero, as in Rethink's simulator
  bias,             ///< the force along z gets VALUE newtons (12) on top
  drop_commands,    ///< commands are ignored for VALUE seconds (5)
  jump_joints,      ///< the measured left_s1 is off by VALUE radians (0.3) from now on
  old_state,        ///< * /robot/state has the md5 sum of firmware before 1.2
  no_data,          ///< * of the stream VALUE (endpoint; joints, state, collision) nothing ever comes
  disabled,         ///< * the robot begins disabled
  tucked,           ///< * the arm begins tucked and disabled, and refuses to be enabled
  ik_invalid,       ///< IKService says that there is no solution
  ik_slow,          ///< it answers after VALUE seconds (5) of real time
  ik_absent,        ///< * it is not there
  software,         ///< * the robot's software has version VALUE
  freeze_clock,     ///< /clock stops; the robot goes on
  die               ///< the program is gone at once
};

/// A fault as asked for.
struct Fault {
  FaultKind kind;
  double amount = 0.0;  ///< VALUE, or its default, where it is a number
  std::string text;     ///< VALUE where it is none
};

/// Reads NAME or NAME=VALUE. Throws Error for a name that there is not, and for a value that does not fit.
Fault parse_fault(const std::string& words);

/// Whether it is of those that hold from the start, whenever they are asked to begin.
bool starts_with_robot(FaultKind kind);

/// When a fault begins: at the start, or when the tip comes down through a height.
struct Trigger {
  int descent = 0;      ///< 0: at the start; else on this one of the times that it comes through
  double height = 0.0;  ///< above the desk, metres
};

/// Reads `start` or DESCENT:HEIGHT, for example `2:8cm`. Throws Error.
Trigger parse_trigger(const std::string& words);

}  // namespace palpate::fake_baxter
