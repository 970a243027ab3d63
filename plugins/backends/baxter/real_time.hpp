// SPDX-License-Identifier: MIT
// The control loop before everything else that this computer does.
#pragma once

#include <string>

#include <pthread.h>

namespace palpate::baxter {

/// For as long as it lives the calling thread is scheduled in real time (SCHED_FIFO), where the system allows that.
class RealTime {
 public:
  /// With `wanted` false it does nothing: of a simulated clock no period is real.
  explicit RealTime(bool wanted);
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  /// What came of it, for the diary, with what it takes; empty if it was not wanted.
  const std::string& words() const { return words_; }

 private:
  bool granted_ = false;
  int policy_before_ = 0;
  sched_param before_{};
  std::string words_;
};

}  // namespace palpate::baxter
