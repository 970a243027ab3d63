// SPDX-License-Identifier: MIT
// What Tapper does when a rule is broken.
#include "baxter/tapper.hpp"
#include "tapping/words.hpp"

namespace palpate::baxter {
namespace {

using tapping::centimetres;
using Then = Fault::Then;

constexpr double kPeriod = tapping::GuardedTap::kPeriod;
constexpr double kHeld = 0.5;        ///< s for which the measured joints are sent at a stop
constexpr double kReflexEnds = 4.0;  ///< s: the firmware's own stop lasts two
constexpr int kReflexes = 20;        ///< how often it may fire on the way up

}  // namespace

/// Does what may still be done and tells, in half a sentence, where that left the arm.
std::string Tapper::recover(const Fault& fault) {
  if (fault.then == Then::silence) return kSilent;
  const std::string where = "the arm holds " + centimetres(height() - scene_.desk()) + " above the desk";
  recovering_ = true;
  if (const auto other = hold(seen_.joints->position)) return std::string(kSilent) + ": " + other->reason;
  if (fault.then == Then::hold) return where;
  try {
    for (int attempt = 1;; ++attempt) {
      try {
        outlast_reflex();
        climb(way_up());
        settle(*watch_.last_sent());
        return "the arm was raised to the height of travel";
      } catch (const Fault& again) {
        if (!again.reflex || attempt == kReflexes) throw;
      }
    }
  } catch (const NoPath& none) {
    return where + ", it could not be raised: " + none.reason;
  } catch (const Fault& other) {
    if (other.then == Then::silence) return std::string(kSilent) + ": " + other.reason;
    hold(seen_.joints->position);
    return where + ", it was not raised: " + other.reason;
  }
}

/// Waits, where the arm is, until its own reflex lets it go. One that is left pressing fires again as soon as that: a
/// little way up is made each time, until there is less than 16 N.
void Tapper::outlast_reflex() {
  watch_.begin();
  watch_.expect_collision(true);
  next_ = seen_.now;
  const double patience = seen_.now + kReflexEnds;
  const Joints here = seen_.joints->position;
  while (seen_.now < patience && seen_.collision && seen_.collision->collision) step(here);
  watch_.expect_collision(false);
  step(seen_.joints->position);
}

Fault Tapper::standstill() { return {"the clock of the robot's network stands still: its sender is gone"}; }

/// Sends the joints, which keep the arm where it is, for a while; or less, where a rule comes to ask for silence. That
/// rule, if one did.
std::optional<Fault> Tapper::hold(Joints joints) {
  watch_.begin();
  next_ = seen_.now;
  for (double left = kHeld; left > 0.0; left -= kPeriod) {
    robot_.command(joints);
    if (!pass()) return standstill();
    std::optional<Fault> fault = watch_.look(seen_, tip_);
    if (fault && fault->then == Then::silence) return fault;
  }
  return std::nullopt;
}

}  // namespace palpate::baxter
