// SPDX-License-Identifier: MIT
// How often something new comes. The robot sends a hundred times a second and the driver looks as often; but either may
// be late, and then the latest reading is one that was looked at before. What counts readings must count new ones.
#pragma once

#include "baxter/robot.hpp"

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
  bool hear(const Arrival& arrival, double now);

  /// How many were new within the last kWindow seconds, with those that came and went between two looks, where the
  /// arrivals are counted.
  int heard() const;

  /// Counts anew. What was heard last is still not new.
  void begin() { heard_.clear(); }

 private:
  struct Heard {
    double time;
    long count;
  };
  std::optional<double> stamp_;
  std::deque<Heard> heard_;
};

}  // namespace palpate::baxter
