// SPDX-License-Identifier: MIT
// Whether the robot may move: what /robot/set_super_* and the emergency stop do, as /robot/state tells it.
#pragma once

#include "baxter/robot.hpp"

namespace palpate::fake_baxter {

/// The state machine of the robot's brakes.
class Assembly {
 public:
  using State = baxter::StateReading;

  explicit Assembly(bool enabled) {
    state_.ready = true;
    state_.enabled = enabled;
  }

  const State& state() const { return state_; }

  /// Has no effect while something is wrong, and cannot enable an arm that is `tucked`.
  void enable(bool wanted, bool tucked) {
    if (!wanted) state_.enabled = false;
    if (wanted && !state_.stopped && !state_.error && !tucked) state_.enabled = true;
  }

  /// The stop of the software.
  void stop() { halt(State::Button::unpressed, State::Source::unknown); }

  void press() { halt(State::Button::pressed, State::Source::user); }
  void release() { state_.estop_button = State::Button::released; }

  void fail() {
    halt(State::Button::unpressed, State::Source::fault);
    state_.error = true;
  }

  /// Clears what was wrong and leaves the robot disabled; refused while the button is pressed.
  void reset() {
    if (state_.estop_button == State::Button::pressed) return;
    state_ = State{};
    state_.ready = true;
  }

 private:
  void halt(State::Button button, State::Source source) {
    state_.enabled = false;
    state_.stopped = true;
    state_.estop_button = button;
    state_.estop_source = source;
  }

  State state_;
};

}  // namespace palpate::fake_baxter
