// SPDX-License-Identifier: MIT
// Time of a tap by phase.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace palpate {

enum class Phase { robot, fit, infer, acquire, log };
constexpr std::size_t kPhases = 5;
constexpr std::array<const char*, kPhases> kPhaseNames{"robot", "fit", "infer", "acquire", "log"};

/// Seconds of wall time by phase. Phases nest: the time of an inner phase does not count for the outer one.
class PhaseClock {
 public:
  /// Adds the time between its construction and its destruction to `phase`.
  class Scope {
   public:
    /// Does nothing if `clock` is null.
    Scope(PhaseClock* clock, Phase phase) : clock_(clock), outer_(clock != nullptr ? clock->active_ : kNone) {
      if (clock_ != nullptr) clock_->turn_to(static_cast<int>(phase));
    }
    ~Scope() {
      if (clock_ != nullptr) clock_->turn_to(outer_);
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    PhaseClock* clock_;
    int outer_;
  };

  /// Returns the seconds since the last call, by phase.
  std::array<double, kPhases> take() {
    turn_to(active_);
    const auto out = seconds_;
    seconds_.fill(0.0);
    return out;
  }

 private:
  static constexpr int kNone = -1;

  void turn_to(int phase) {
    const auto now = std::chrono::steady_clock::now();
    if (active_ != kNone)
      seconds_[static_cast<std::size_t>(active_)] += std::chrono::duration<double>(now - since_).count();
    since_ = now;
    active_ = phase;
  }

  std::array<double, kPhases> seconds_{};
  std::chrono::steady_clock::time_point since_{};
  int active_ = kNone;
};

}  // namespace palpate
