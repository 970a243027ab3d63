// SPDX-License-Identifier: MIT
#include "fake_baxter/delivery.hpp"

#include <utility>

namespace palpate::fake_baxter {
namespace {

constexpr double kSlack = 1e-9;  // of times that are sums of periods, s

template <class Reading>
void arrive(std::optional<Reading>& reading, double now) {
  if (reading) reading->received = now;
}

}  // namespace

std::vector<Said> Delivery::take(const Body& body) {
  waiting_.push_back(body.said());
  const Fault* bursts = body.active(FaultKind::bursts);
  const bool between = bursts != nullptr && body.now() < latest_ + bursts->amount - kSlack;
  if (between || body.active(FaultKind::stall) != nullptr) return {};
  latest_ = body.now();
  for (Said& said : waiting_) {
    arrive(said.joints, latest_);
    arrive(said.endpoint, latest_);
    arrive(said.state, latest_);
    arrive(said.collision, latest_);
    arrive(said.avoidance, latest_);
  }
  return std::exchange(waiting_, {});
}

}  // namespace palpate::fake_baxter
