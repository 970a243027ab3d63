// SPDX-License-Identifier: MIT
#pragma once

#include <palpate/random.hpp>

#include <cmath>
#include <optional>

namespace palpate::backends {

/// Standard normal numbers from a stream, by Box and Muller's method: in pairs, of which the second waits.
class Normal {
 public:
  explicit Normal(Random random) : random_(random) {}

  double operator()() {
    if (spare_) {
      const double out = *spare_;
      spare_.reset();
      return out;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random_.uniform()));
    const double angle = 2.0 * 3.14159265358979323846 * random_.uniform();
    spare_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

  /// The stream itself, for what is not normal.
  Random& uniform() { return random_; }

 private:
  Random random_;
  std::optional<double> spare_;
};

}  // namespace palpate::backends
