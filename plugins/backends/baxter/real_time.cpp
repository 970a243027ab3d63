// SPDX-License-Identifier: MIT
#include "baxter/real_time.hpp"

#include <cstring>

namespace palpate::baxter {
namespace {

/// Above everything ordinary, below the kernel's own threads for interrupts (50).
constexpr int kPriority = 20;

}  // namespace

RealTime::RealTime(bool wanted) {
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

RealTime::~RealTime() {
  if (granted_) pthread_setschedparam(pthread_self(), policy_before_, &before_);
}

}  // namespace palpate::baxter
