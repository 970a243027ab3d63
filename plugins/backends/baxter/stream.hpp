// SPDX-License-Identifier: MIT
// How often something new comes. The robot sends a hundred times a second and the driver looks as often; but either may
// be late, and then the latest reading is one that was looked at before. What counts readings must count new ones.
#pragma once

#include "baxter/robot.hpp"

#include <algorithm>
#include <deque>
#include <optional>

namespace palpate::baxter {

/// The new readings of one stream within the last half second.
class Stream {
 public:
  static constexpr double kWindow = 0.5;  ///< s
  /// The fewest in a window: 50 Hz. Three readings, which make a contact, then take 60 ms; at 2 cm/s that is 1.2 mm.
  static constexpr int kFewest = 25;

  /// Takes what is the latest at `now` (s); whether it is new, that is, has another stamp than the one before.
  bool hear(const Arrival& arrival, double now) {
    while (!heard_.empty() && heard_.front().time < now - kWindow - kSlack) heard_.pop_front();
    if (stamp_ == arrival.stamp) return false;
    stamp_ = arrival.stamp;
    heard_.push_back({now, arrival.count});
    return true;
  }

  /// How many were new within the last kWindow seconds, with those that came and went between two looks, where the
  /// arrivals are counted.
  int heard() const {
    if (heard_.empty()) return 0;
    const long counted = heard_.back().count - heard_.front().count + 1;
    return static_cast<int>(std::max(counted, static_cast<long>(heard_.size())));
  }

  /// Counts anew. What was heard last is still not new.
  void begin() { heard_.clear(); }

 private:
  /// A stream of exactly the fewest has as many in every window, whatever the sums of its times round to.
  static constexpr double kSlack = 1e-6;

  struct Heard {
    double time;
    long count;
  };
  std::optional<double> stamp_;
  std::deque<Heard> heard_;
};

}  // namespace palpate::baxter
