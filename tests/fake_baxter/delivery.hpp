// SPDX-License-Identifier: MIT
// The way from the robot to who listens, on which what it says may be held up.
#pragma once

#include "fake_baxter/body.hpp"

#include <vector>

namespace palpate::fake_baxter {

class Delivery {
 public:
  /// What arrives in this period, in the order in which it was said: by itself what is said in it, behind a stall or
  /// between two bursts nothing, after it all that was held up. `received` is when it arrives, stamps are as they were.
  /// To be called once a period.
  std::vector<Said> take(const Body& body);

 private:
  std::vector<Said> waiting_;
  double latest_ = 0.0;  ///< when something arrived, s
};

}  // namespace palpate::fake_baxter
