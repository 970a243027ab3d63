// SPDX-License-Identifier: MIT
// What motion and arm add to all heights alike, learnt from the desk: its height is known, so what taps on it show
// beyond is an offset, and a drift over the arm's time.
//
// Linear regression with a normal prior over both is a Gaussian process over time, of covariance o^2 + d^2 t t'
// (Rasmussen and Williams 2006, section 2.1.2).
//
// Which contacts are with the desk, nobody says, but nothing is lower than the desk: y = offset + drift + z + noise,
// z >= 0, and z = 0 on it. So the lowest bound from above what is added to all, and are taken for the desk first: a
// forward search (Atkinson and Riani 2000) takes in one contact after the other, always the one that lies lowest by
// what those before it tell, in deviations of its own prediction, and ends where the next lies clearly above. The
// deviation is that of the regression: noise, what may have drifted between the times, what motions may differ by. What
// was taken for the desk as long as there was nothing lower is known so for what it is, once the desk is touched. A
// contact that is low all alone may be one that lies, and bounds nothing; two that agree do.
//
// Not every contact that is so low is one with the bare desk: the rim of a dome or a jerk of the force is as low: those
// at a rim are left out, the others judged as the taps of a surface are (gp/outlier_posterior.hpp).
//
// Each motion adds a little of its own to what all add: a fifth of the prior variance of the offset is each's alone.
//
// What an object's own softness adds beyond the desk's is not in it: nothing that is touched tells.
#pragma once

#include "gp/outlier_posterior.hpp"

#include <palpate/types.hpp>

#include <vector>

namespace palpate {

/// Prior of the offset, in standard deviations.
struct OffsetPrior {
  double offset;  ///< metres
  double drift;   ///< metres per second
  double noise;   ///< of a contact with the desk, metres
};

class OffsetModel {
 public:
  explicit OffsetModel(const OffsetPrior& prior) : prior_(prior) {}

  /// The next contact, `seconds` into the run, `excess` metres above where the desk is; `motion`: by which it was made.
  void add(const Target& place, double seconds, double excess, int motion = 0);

  /// Whether a contact, counted from 0, lies clearly above the desk, by all that were added.
  bool above(std::size_t contact) const { return above_[contact]; }
  /// What is so many deviations of its prediction above it does.
  static constexpr double kAboveDeskSigmas = 2.4;

  struct Estimate {
    double value = 0.0;     ///< to be taken off a height, metres
    double variance = 0.0;  ///< of it, square metres
  };
  Estimate at(double seconds, int motion = 0) const;
  double noise() const { return prior_.noise; }

 private:
  struct When {
    double seconds;
    int motion;
  };
  struct Touched {
    Target place;
    When when;
    Eigen::Index own;  ///< place of its motion among motions_
    double excess;
  };

  static constexpr double kShared = 0.8;

  void find_desk();
  void search_from_below(std::vector<bool>& left) const;
  bool at_a_rim(const Target& place) const;
  void judge_all();
  double covariance(const When& a, const When& b) const {
    const double share = a.motion == b.motion ? 1.0 : kShared;
    return share * prior_.offset * prior_.offset + prior_.drift * prior_.drift * a.seconds * b.seconds;
  }

  OffsetPrior prior_;
  std::vector<int> motions_;      ///< that contacts were made by
  std::vector<Touched> touched_;  ///< all contacts
  std::vector<bool> above_;       ///< of these
  std::vector<When> judged_;      ///< when those of them were made that are judged
  OutlierPosterior posterior_;
};

}  // namespace palpate
