// SPDX-License-Identifier: MIT
// Estimates the error that motion and arm add to all heights: a constant offset and a drift over time. The estimate
// uses contacts with the desk, whose height is known.
//
// Offset and drift have normal priors with the standard deviations o and d. This linear regression is a Gaussian
// process over the time t, with the covariance o^2 + d^2 t t' (Rasmussen and Williams 2006, section 2.1.2).
//
// The label of a contact, desk or object, is unknown, but nothing is below the desk. A height relative to the desk is y
// = offset + drift + z + noise, with z = 0 on the desk and z >= 0 elsewhere. So the heights of the lowest contacts are
// upper bounds of the error, and these contacts count as contacts with the desk at first. A forward search (Atkinson
// and Riani 2000) then repeatedly adds the contact with the lowest residual to the desk contacts. Residuals are divided
// by the standard deviation of their prediction. The search ends when the next contact is clearly above the desk. The
// standard deviation of a prediction covers the noise, the drift between the times, and differences between motions. If
// an object contact counts as a desk contact at first, this is corrected once the desk itself is touched. A single low
// contact may be an outlier, so it is not used as a bound. Two low contacts that agree are used.
//
// A contact may count as desk although the tool did not touch the bare desk. Examples are the rim of a dome, or a
// sudden change of the force reading. Desk contacts within 3 cm of an object contact lower than 4 cm are not used. The
// other desk contacts are tested for outliers like taps on a surface (gp/outlier_posterior.hpp).
//
// Each motion has an offset of its own in addition to the common offset. A fifth of the prior variance o^2 belongs to
// the motion's own offset.
//
// An object may be softer than the desk, which makes its heights too low. The model does not contain this error,
// because no contact reveals it.
#pragma once

#include "gp/outlier_posterior.hpp"

#include <palpate/types.hpp>

#include <vector>

namespace palpate {

/// Prior of the offset, in standard deviations.
struct OffsetPrior {
  double offset;  ///< metres
  double drift;   ///< metres per second
  double noise;   ///< standard deviation of the height of a contact with the desk, metres
};

class OffsetModel {
 public:
  explicit OffsetModel(const OffsetPrior& prior) : prior_(prior) {}

  /// Adds the next contact. `seconds`: robot time since the beginning of the run; `excess`: height above the desk,
  /// metres; `motion`: index of the motion that made the contact.
  void add(const Target& place, double seconds, double excess, int motion = 0);

  /// Returns whether a contact (counted from 0) is clearly above the desk, given all contacts so far.
  bool above(std::size_t contact) const { return above_[contact]; }
  /// A contact counts as above the desk if its height exceeds the predicted height of the desk by this many standard
  /// deviations.
  static constexpr double kAboveDeskSigmas = 2.4;

  struct Estimate {
    double value = 0.0;     ///< error to be subtracted from a height, metres
    double variance = 0.0;  ///< variance of that error, square metres
  };
  Estimate at(double seconds, int motion = 0) const;
  double noise() const { return prior_.noise; }

 private:
  struct OffsetInput {
    double seconds;
    int motion;
  };
  struct OffsetContact {
    Target place;
    OffsetInput when;
    Eigen::Index own;  ///< index of its motion in motions_
    double excess;
  };

  static constexpr double kShared = 0.8;

  void find_desk();
  void search_from_below(std::vector<bool>& left) const;
  bool at_a_rim(const Target& place) const;
  void judge_all();
  double covariance(const OffsetInput& a, const OffsetInput& b) const {
    const double share = a.motion == b.motion ? 1.0 : kShared;
    return share * prior_.offset * prior_.offset + prior_.drift * prior_.drift * a.seconds * b.seconds;
  }

  OffsetPrior prior_;
  std::vector<int> motions_;            ///< motions of the contacts so far
  std::vector<OffsetContact> touched_;  ///< all contacts
  std::vector<bool> above_;             ///< flag per contact
  std::vector<OffsetInput> judged_;     ///< times and motions of the contacts that are tested for outliers
  OutlierPosterior posterior_;
};

}  // namespace palpate
