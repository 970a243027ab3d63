// SPDX-License-Identifier: MIT
// Faults of the simulated robot, and the conditions that start them.
#pragma once

#include <optional>
#include <string>

namespace palpate::fake_baxter {

/// Kinds of faults, with their names on the command line. describe_faults() explains them.
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

/// A requested fault.
struct Fault {
  FaultKind kind;
  double amount = 0.0;  ///< VALUE or its default, if it is a number
  std::string text;     ///< VALUE, if it is a text
};

/// Parses NAME or NAME=VALUE. Throws Error for an unknown name or an invalid value.
Fault parse_fault(const std::string& words);

/// Returns a list of all faults, one line each. Those marked * hold from the start, independently of their trigger.
std::string describe_faults();

/// Returns whether faults of this kind hold from the start, independently of their trigger.
bool starts_with_robot(FaultKind kind);

/// Begin of a fault: the start, or a descent of the tip through a height.
struct Trigger {
  int descent = 0;      ///< 0: at the start; else number of the descent
  double height = 0.0;  ///< m above the desk
};

/// Parses `start` or DESCENT:HEIGHT, for example `2:8cm`. Throws Error.
Trigger parse_trigger(const std::string& words);

}  // namespace palpate::fake_baxter
