// SPDX-License-Identifier: MIT
// The control loop before everything else that this computer does.
#pragma once

#include <cstring>
#include <string>

#include <pthread.h>

namespace palpate::baxter {

/// For as long as it lives the calling thread is scheduled in real time (SCHED_FIFO), where the system allows that.
class RealTime {
 public:
  /// With `wanted` false it does nothing: of a simulated clock no period is real.
  explicit RealTime(bool wanted) {
    if (!wanted) return;
    pthread_getschedparam(pthread_self(), &policy_before_, &before_);
    sched_param here{};
    here.sched_priority = kPriority;
    const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &here);
    granted_ = refused == 0;
    words_ = granted_ ? "real-time scheduling: granted"
                      : std::string("real-time scheduling: not allowed (") + std::strerror(refused) +
                            "); a line '@palpate - rtprio 20' in /etc/security/limits.d/palpate.conf allows it to the "
                            "group palpate from the next login on";
  }
  ~RealTime() {
    if (granted_) pthread_setschedparam(pthread_self(), policy_before_, &before_);
  }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  /// What came of it, for the diary, with what it takes; empty if it was not wanted.
  const std::string& words() const { return words_; }

 private:
  /// Above everything ordinary, below the kernel's own threads for interrupts (50).
  static constexpr int kPriority = 20;

  bool granted_ = false;
  int policy_before_ = 0;
  sched_param before_{};
  std::string words_;
};

}  // namespace palpate::baxter
