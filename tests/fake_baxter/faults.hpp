// SPDX-License-Identifier: MIT
// What may go wrong with the robot of the tests, and when.
#pragma once

#include <optional>
#include <string>

namespace palpate::fake_baxter {

/// A fault, with the name that it has on the command line; what each does is told by describe_faults().
enum class FaultKind {
  estop,
  stop,
  error,
  complaint,
  squish,
  freeze_endpoint,
  kill_endpoint,
  kill_joints,
  kill_state,
  stale_stamps,
  second_sender,
  nan_wrench,
  zero_wrench,
  bias,
  spikes,
  moving_force,
  drop_commands,
  jump_joints,
  old_state,
  no_data,
  disabled,
  tucked,
  ik_invalid,
  ik_slow,
  ik_absent,
  software,
  freeze_clock,
  avoid,
  speed_ratio,
  command_timeout,
  slow_endpoint,
  slow_force,
  bursts,
  stall,
  delay,
  jitter,
  wrench_filter,
  force_drift,
  caught,
  die
};

/// A fault as asked for.
struct Fault {
  FaultKind kind;
  double amount = 0.0;  ///< VALUE, or its default, where it is a number
  std::string text;     ///< VALUE where it is none
};

/// Reads NAME or NAME=VALUE. Throws Error for a name that there is not, and for a value that does not fit.
Fault parse_fault(const std::string& words);

/// All of them with what they do, a line each. Those marked * hold from the start, whenever they are asked to begin.
std::string describe_faults();

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
