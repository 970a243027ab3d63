// SPDX-License-Identifier: MIT
// Speed for accuracy, tap by tap: where a backend has several motions, what a tap is worth for each second that it
// takes.
//
// A score says what a perfect tap at a place would tell. Of that a motion tells the share in which its height is
// believed, v / (v + d^2) with the variance v of what is not known there, noise included, and its own deviation d; and
// as often as its taps come to a contact at all. What it takes is the mean of the times on an object and beside it.
// Times, deviations and failures are first the motion's own idea, then what its taps show.
#pragma once

#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"
#include "gp/candidates.hpp"

#include <palpate/motions.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

class Pace {
 public:
  /// `candidates` must outlive it.
  Pace(std::shared_ptr<const Motions> motions, const Candidates& candidates, double desk);

  /// What is read of the belief for it.
  static constexpr Quantities kReads = Quantity::height | Quantity::probability;

  /// Looks at every motion at every candidate, as of now, for a tap after one at `previous`.
  void look(const TapBelief& belief, const std::optional<Target>& previous);

  /// What each score is worth a second by the best motion of its candidate; until the next look().
  const Eigen::VectorXd& per_second(const Eigen::VectorXd& scores);

  /// That motion, and the time that it is expected to take, seconds.
  int motion(int candidate) const { return best_[static_cast<std::size_t>(candidate)]; }
  double seconds(int candidate) const { return seconds_(candidate); }

  /// What the motion of a tap adds to the noise of its height, metres.
  double deviation(int motion) const;

  /// Learns from a tap; `excess`: metres by which a contact with the bare desk was off, if it was one.
  void observe(const PastTap& tap, const std::optional<Target>& previous, std::optional<double> excess);

 private:
  /// What the taps of a motion have shown.
  struct Shown {
    int taps = 0;
    int failed = 0;
    double late = 0.0;  ///< seconds beyond those expected of what was met, a sum
    int timed = 0;
    double squares = 0.0;  ///< of the heights of the desk, square metres
    int on_desk = 0;
  };

  double success(const Shown& shown) const;
  double late(const Shown& shown) const;

  std::shared_ptr<const Motions> motions_;
  const Candidates& candidates_;
  double desk_;
  std::vector<Shown> shown_;
  std::vector<int> best_;
  Eigen::VectorXd seconds_;  ///< of the best
  Eigen::VectorXd share_;    ///< of a score that it yields a second
  Eigen::VectorXd worth_;
};

}  // namespace palpate
