// SPDX-License-Identifier: MIT
#include "baxter/stream.hpp"

namespace palpate::baxter {
namespace {

/// A stream of exactly the fewest has as many in every window, whatever the sums of its times round to.
constexpr double kSlack = 1e-6;

}  // namespace

bool Stream::hear(const Arrival& arrival, double now) {
  while (!times_.empty() && times_.front() < now - kWindow - kSlack) times_.pop_front();
  if (stamp_ == arrival.stamp) return false;
  stamp_ = arrival.stamp;
  times_.push_back(now);
  return true;
}

}  // namespace palpate::baxter
