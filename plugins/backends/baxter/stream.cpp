// SPDX-License-Identifier: MIT
#include "baxter/stream.hpp"

#include <algorithm>

namespace palpate::baxter {
namespace {

/// A stream of exactly the fewest has as many in every window, whatever the sums of its times round to.
constexpr double kSlack = 1e-6;

}  // namespace

bool Stream::hear(const Arrival& arrival, double now) {
  while (!heard_.empty() && heard_.front().time < now - kWindow - kSlack) heard_.pop_front();
  if (stamp_ == arrival.stamp) return false;
  stamp_ = arrival.stamp;
  heard_.push_back({now, arrival.count});
  return true;
}

int Stream::heard() const {
  if (heard_.empty()) return 0;
  const long counted = heard_.back().count - heard_.front().count + 1;
  return static_cast<int>(std::max(counted, static_cast<long>(heard_.size())));
}

}  // namespace palpate::baxter
