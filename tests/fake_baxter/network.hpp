// SPDX-License-Identifier: MIT
// One direction of the network between robot and driver.
#pragma once

#include <palpate/random.hpp>

#include <algorithm>

namespace palpate::fake_baxter {

/// Delays messages and keeps their order, as TCP does.
class Network {
 public:
  explicit Network(Random random) : random_(random) {}

  /// Returns the arrival of a message sent at `sent`: after `delay` and a uniform fraction of `jitter`, and not before
  /// earlier messages. All times in s.
  double arrival(double sent, double delay, double jitter) {
    latest_ = std::max(latest_, sent + delay + (jitter > 0.0 ? jitter * random_.uniform() : 0.0));
    return latest_;
  }

 private:
  Random random_;
  double latest_ = -1e9;
};

}  // namespace palpate::fake_baxter
