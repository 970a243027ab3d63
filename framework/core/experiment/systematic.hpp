// SPDX-License-Identifier: MIT
// What motion and arm add to all heights alike, learnt from the desk: its height is known, so what taps on it show
// beyond is an offset, and a drift over the arm's time.
//
// Linear regression with a normal prior over both is a Gaussian process over time, of covariance o^2 + d^2 t t'
// (Rasmussen and Williams 2006, section 2.1.2). Not every contact that is so low is one with the bare desk: the rim of
// a dome or a jerk of the force is as low: those at a rim are left out, the others judged as the taps of a surface are
// (gp/lies.hpp).
//
// Each motion adds a little of its own to what all add: a fifth of the prior variance of the offset is each's alone.
//
// What an object's own softness adds beyond the desk's is not in it: nothing that is touched tells.
#pragma once

#include "gp/lies.hpp"

#include <palpate/types.hpp>

#include <vector>

namespace palpate {

class Systematic {
 public:
  /// Prior standard deviations, metres and metres a second, and that of the noise of a contact with the desk, metres.
  Systematic(double offset, double drift, double noise);

  /// The next contact, `seconds` into the run, `excess` metres above where the desk is; `on`: taken for one with an
  /// object; `motion`: by which it was made.
  void add(const Target& place, double seconds, double excess, bool on, int motion = 0);

  struct Estimate {
    double value = 0.0;     ///< to be taken off a height, metres
    double variance = 0.0;  ///< of it, square metres
  };
  Estimate at(double seconds, int motion = 0) const;
  double noise() const { return noise_; }

 private:
  struct When {
    double seconds;
    int motion;
  };
  struct Touched {
    Target place;
    When when;
    double excess;
  };

  static constexpr double kShared = 0.8;

  bool at_a_rim(const Target& place) const;
  void judge_all();
  double covariance(const When& a, const When& b) const {
    const double share = a.motion == b.motion ? 1.0 : kShared;
    return share * offset_ * offset_ + drift_ * drift_ * a.seconds * b.seconds;
  }

  double offset_;
  double drift_;
  double noise_;
  std::vector<Touched> highs_;  ///< contacts with an object
  std::vector<Touched> lows_;   ///< the others
  std::vector<When> judged_;    ///< when those of them were made that are judged
  Judgement judgement_;
};

}  // namespace palpate
