// SPDX-License-Identifier: MIT
// Whether a thread got to run as often as it wanted to: what tells a silent network from a busy computer.
#pragma once

#include <algorithm>
#include <deque>

namespace palpate::baxter {

/// Beats of a thread that wants to run many times a second. Not guarded. Times are seconds of one clock.
class Pulse {
 public:
  static constexpr double kRemembered = 1.0;  ///< s
  static constexpr double kNoted = 0.01;      ///< s; shorter gaps are the thread's own rest

  explicit Pulse(double now) : last_(now) {}

  void beat(double now) {
    if (now - last_ > kNoted) gaps_.push_back({now, now - last_});
    last_ = now;
    while (!gaps_.empty() && gaps_.front().end < now - kRemembered) gaps_.pop_front();
  }

  /// The longest gap of those that ended within the last kRemembered seconds and the one that is going on; 0 if all
  /// were short.
  double longest(double now) const {
    double out = now - last_ > kNoted ? now - last_ : 0.0;
    for (const Gap& gap : gaps_) {
      if (gap.end >= now - kRemembered) out = std::max(out, gap.length);
    }
    return out;
  }

 private:
  struct Gap {
    double end, length;
  };
  std::deque<Gap> gaps_;
  double last_;
};

}  // namespace palpate::baxter
