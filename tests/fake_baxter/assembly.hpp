// SPDX-License-Identifier: MIT
// Whether the robot may move: what /robot/set_super_* and the emergency stop do, as /robot/state tells it.
#pragma once

#include "baxter/robot.hpp"

namespace palpate::fake_baxter {

/// The state machine of the robot's brakes, as Rethink's comments on AssemblyState and its RobotEnable have it.
class Assembly {
 public:
  using State = baxter::StateReading;

  explicit Assembly(bool enabled) { set_enabled(enabled); }

  const State& state() const { return state_; }

  /// Has no effect while the robot is stopped, and cannot enable an arm that is `tucked`.
  void enable(bool wanted, bool tucked) {
    if (!wanted) set_enabled(false);
    if (wanted && !state_.stopped && !tucked) set_enabled(true);
  }

  /// The stop of the software: whoever else than the button stops the robot, the button is then "unknown".
  void stop() { halt(State::Button::unknown, State::Source::unknown); }

  void press() { halt(State::Button::pressed, State::Source::user); }
  void release() { state_.estop_button = State::Button::released; }

  /// A fault of a joint, which stops the robot.
  void fail() {
    halt(State::Button::unknown, State::Source::fault);
    state_.error = true;
  }

  /// A component has an error that stops nothing and that no reset clears.
  void complain() { state_.error = complaint_ = true; }

  /// Clears what stopped the robot and leaves it disabled; refused while the button is pressed.
  void reset() {
    if (state_.estop_button == State::Button::pressed) return;
    state_ = State{};
    state_.error = complaint_;
  }

 private:
  /// Ready is who is enabled and need not home its joints, which this one never needs.
  void set_enabled(bool enabled) { state_.ready = state_.enabled = enabled; }

  void halt(State::Button button, State::Source source) {
    set_enabled(false);
    state_.stopped = true;
    state_.estop_button = button;
    state_.estop_source = source;
  }

  State state_;
  bool complaint_ = false;
};

}  // namespace palpate::fake_baxter
