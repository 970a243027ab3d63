// SPDX-License-Identifier: MIT
// The way from the robot to who listens, on which what it says may be held up.
#pragma once

#include "fake_baxter/body.hpp"
#include "fake_baxter/network.hpp"

#include <vector>

namespace palpate::fake_baxter {

class Delivery {
 public:
  /// Returns what arrives in this period, in the order in which it was said. Without a fault that is what is said in
  /// it; `delay` and `jitter` hold each message up, `stall` and `bursts` all of them. `received` is the time of
  /// arrival, stamps are as they were. Call it once per period.
  std::vector<Said> take(const Body& body);

 private:
  struct Sent {
    Said said;
    double arrives;  ///< s
  };
  std::vector<Sent> waiting_;
  Network network_{Random(1, "fake_baxter/said")};
  double latest_ = 0.0;  ///< when something arrived, s
};

}  // namespace palpate::fake_baxter
