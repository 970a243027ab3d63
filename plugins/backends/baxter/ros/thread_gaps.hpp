// SPDX-License-Identifier: MIT
// Gaps in the execution of a thread, which distinguish a busy computer from a silent network.
#pragma once

#include <algorithm>
#include <deque>

namespace palpate::baxter {

/// Records the beats of a thread that should run many times per second. Not thread-safe. Times are in s of one clock.
class Heartbeat {
 public:
  static constexpr double kRemembered = 1.0;  ///< s
  static constexpr double kNoted = 0.01;      ///< s; shorter gaps are the thread's own sleep

  explicit Heartbeat(double now) : last_(now) {}

  void beat(double now) {
    if (now - last_ > kNoted) gaps_.push_back({now, now - last_});
    last_ = now;
    while (!gaps_.empty() && gaps_.front().end < now - kRemembered) gaps_.pop_front();
  }

  /// Returns the longest gap in s: the current gap and those that ended within the last kRemembered seconds; 0 if all
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
