// SPDX-License-Identifier: MIT
// Real-time scheduling of the control loop.
#pragma once

#include <cstring>
#include <string>

#include <pthread.h>

namespace palpate::baxter {

/// Schedules the calling thread in real time (SCHED_FIFO) during the lifetime of this object, if the system allows it.
class RealTime {
 public:
  /// With `wanted` false nothing changes. Periods of a simulated clock are not real time.
  explicit RealTime(bool wanted) {
    if (!wanted) return;
    pthread_getschedparam(pthread_self(), &policy_before_, &before_);
    sched_param here{};
    here.sched_priority = kPriority;
    const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &here);
    granted_ = refused == 0;
    status_ = granted_ ? "real-time scheduling: granted"
                       : std::string("real-time scheduling: not allowed (") + std::strerror(refused) +
                             "); a line '@palpate - rtprio 20' in /etc/security/limits.d/palpate.conf allows it to the "
                             "group palpate from the next login on";
  }
  ~RealTime() {
    if (granted_) pthread_setschedparam(pthread_self(), policy_before_, &before_);
  }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  /// Returns a line for the run's log: whether real-time scheduling was granted, and the remedy if not. Empty with
  /// `wanted` false.
  const std::string& status() const { return status_; }

 private:
  /// Higher than ordinary threads, lower than the kernel's interrupt threads (50).
  static constexpr int kPriority = 20;

  bool granted_ = false;
  int policy_before_ = 0;
  sched_param before_{};
  std::string status_;
};

}  // namespace palpate::baxter
