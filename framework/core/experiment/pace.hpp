// SPDX-License-Identifier: MIT
// Speed for accuracy, tap by tap: where a backend has several motions, the one that tells most in its time.
//
// A tap tells whether there is an object, which is worth the entropy of the footprint there, in bits, whatever the
// motion; and if there is, how high: log2(1 + v / d^2) / 2 bits (Cover and Thomas 2006, section 9.1) of a height of
// variance v by a motion of deviation d. It does so as often as its taps come to a contact at all, and takes the mean
// of the times with an object there and without. Times, deviations and contacts are first the motion's own idea, then
// what its taps show. So the quick motion goes along an outline, and the precise one where only the height is open.
//
// The place is chosen before, by what a tap there tells and not by what it tells a second: near places and tall ones
// are cheap, but those at the edge of an outline, which cost more, bring the scene nearer to the truth for each second.
#pragma once

#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/motions.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

class Pace {
 public:
  Pace(std::shared_ptr<const Motions> motions, double desk);

  /// What is read of the belief for it.
  static constexpr Quantities kReads = Quantity::height | Quantity::probability;

  struct Choice {
    int motion = 0;
    double seconds = 0.0;  ///< that the tap is expected to take
  };
  /// For a tap at `place`, a candidate, after one at `previous`.
  Choice choose(const TapBelief& belief, int candidate, const Target& place,
                const std::optional<Target>& previous) const;

  /// What a motion adds to the noise that the most precise of them has, metres.
  double roughness(int motion) const;

  /// Learns from a tap. Throws Error for a motion that there is not, of a damaged record.
  void observe(const PastTap& tap, const std::optional<Target>& previous);
  /// Learns from all contacts so far, each made by one of the `motions`, how far those with the desk are off.
  void see_desk(const std::vector<Touch>& touches, const std::vector<int>& motions);

 private:
  /// What the taps of a motion have shown.
  struct Shown {
    int taps = 0;
    int contacts = 0;
    double late = 0.0;     ///< seconds beyond those that were expected of what was met, over all contacts
    double squares = 0.0;  ///< of the heights of the desk, square metres
    int on_desk = 0;
  };

  /// Of the height of a tap by a motion, metres.
  double deviation(int motion) const;

  std::shared_ptr<const Motions> motions_;
  double desk_;
  std::vector<Shown> shown_;
};

}  // namespace palpate
