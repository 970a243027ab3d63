// SPDX-License-Identifier: MIT
#include "fake_baxter/delivery.hpp"

#include <algorithm>
#include <utility>

namespace palpate::fake_baxter {
namespace {

constexpr double kSlack = 1e-9;  // s, tolerance for sums of periods

template <class Reading>
void arrive(std::optional<Reading>& reading, double now) {
  if (reading) reading->received = now;
}

}  // namespace

std::vector<RobotMessages> Delivery::take(const Body& body) {
  const double now = body.now();
  waiting_.push_back(
      {body.messages(), network_.arrival(now, body.amount(FaultKind::delay), body.amount(FaultKind::jitter))});
  const Fault* bursts = body.active(FaultKind::bursts);
  const bool between = bursts != nullptr && now < latest_ + bursts->amount - kSlack;
  if (between || body.active(FaultKind::stall) != nullptr) return {};
  const auto end =
      std::find_if(waiting_.begin(), waiting_.end(), [now](const Sent& sent) { return sent.arrives > now + kSlack; });
  std::vector<RobotMessages> out;
  for (auto it = waiting_.begin(); it != end; ++it) out.push_back(std::move(it->said));
  waiting_.erase(waiting_.begin(), end);
  if (!out.empty()) latest_ = now;
  for (RobotMessages& said : out) {
    arrive(said.joints, now);
    arrive(said.endpoint, now);
    arrive(said.state, now);
    arrive(said.collision, now);
    arrive(said.avoidance, now);
  }
  return out;
}

}  // namespace palpate::fake_baxter
