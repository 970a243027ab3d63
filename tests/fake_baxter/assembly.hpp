// SPDX-License-Identifier: MIT
// State machine of the simulated robot's brakes: effects of /robot/set_super_* and of the emergency stop on
// /robot/state.
#pragma once

#include "baxter/robot.hpp"

namespace palpate::fake_baxter {

/// Implements Rethink's comments on AssemblyState and the behaviour of its RobotEnable.
class Assembly {
 public:
  using State = baxter::StateReading;

  explicit Assembly(bool enabled) { set_enabled(enabled); }

  const State& state() const { return state_; }

  /// Enables or disables the robot. Without effect while the robot is stopped; a `tucked` arm cannot be enabled.
  void enable(bool wanted, bool tucked) {
    if (!wanted) set_enabled(false);
    if (wanted && !state_.stopped && !tucked) set_enabled(true);
  }

  /// Stops the robot by software. For every stop without the button, its state is "unknown".
  void stop() { halt(State::Button::unknown, State::EstopSource::unknown); }

  void press() { halt(State::Button::pressed, State::EstopSource::user); }
  void release() { state_.estop_button = State::Button::released; }

  /// Simulates a joint fault, which stops the robot.
  void fail() {
    halt(State::Button::unknown, State::EstopSource::fault);
    state_.error = true;
  }

  /// Sets an error of a component that stops nothing and that no reset clears.
  void complain() { state_.error = complaint_ = true; }

  /// Clears a stop and leaves the robot disabled. Without effect while the button is pressed.
  void reset() {
    if (state_.estop_button == State::Button::pressed) return;
    state_ = State{};
    state_.error = complaint_;
  }

 private:
  /// An enabled robot is ready, because the simulated joints need no homing.
  void set_enabled(bool enabled) { state_.ready = state_.enabled = enabled; }

  void halt(State::Button button, State::EstopSource source) {
    set_enabled(false);
    state_.stopped = true;
    state_.estop_button = button;
    state_.estop_source = source;
  }

  State state_;
  bool complaint_ = false;
};

}  // namespace palpate::fake_baxter
