// SPDX-License-Identifier: MIT
// Where the time of a tap goes.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace palpate {

enum class Phase { robot, fit, infer, acquire, log };
constexpr std::size_t kPhases = 5;
constexpr std::array<const char*, kPhases> kPhaseNames{"robot", "fit", "infer", "acquire", "log"};

/// Seconds of wall time by phase. Phases nest: while an inner one runs, the outer one stands still, so that a model
/// built in the middle of a score counts as inference.
class PhaseClock {
 public:
  /// Time from its birth to its death belongs to `phase`.
  class Scope {
   public:
    Scope(PhaseClock& clock, Phase phase) : clock_(clock), outer_(clock.active_) {
      clock_.turn_to(static_cast<int>(phase));
    }
    ~Scope() { clock_.turn_to(outer_); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    PhaseClock& clock_;
    int outer_;
  };

  /// The seconds since the last call, by phase; starts again from 0.
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
