// SPDX-License-Identifier: MIT
#include "baxter/real_time.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

int policy() {
  int out = 0;
  sched_param parameters{};
  pthread_getschedparam(pthread_self(), &out, &parameters);
  return out;
}

TEST(RealTimeScheduling, HoldsForATapWhereItIsAllowedAndElseSaysWhatItTakes) {
  const int before = policy();
  {
    const RealTime real(true);
    if (policy() == SCHED_FIFO) {
      EXPECT_EQ(real.status(), "real-time scheduling: granted");
    } else {
      EXPECT_EQ(policy(), before);
      EXPECT_THAT(real.status(), testing::HasSubstr("/etc/security/limits.d/palpate.conf"));
    }
  }
  EXPECT_EQ(policy(), before);
  const RealTime simulated(false);
  EXPECT_EQ(policy(), before);
  EXPECT_EQ(simulated.status(), "");
}

}  // namespace
}  // namespace palpate::baxter
