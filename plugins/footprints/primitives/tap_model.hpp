// SPDX-License-Identifier: MIT
// Likelihood of a hypothesis: probability of the taps' labels and heights. Logarithms are integers in units of 2^-20,
// so that sums have the same bytes in any order.
#pragma once

#include <palpate/footprint.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// A natural logarithm in units of 2^-20, with conversions from and to real numbers.
using LogUnits = std::int64_t;
LogUnits to_units(double logarithm);
inline double from_units(LogUnits units) { return static_cast<double>(units) * 0x1p-20; }

/// Probability of a tap's label, given its depth in the deepest primitive of a hypothesis. The probability is
/// approximate if two rims are within reach of the noise. Where two primitives overlap, the probability of an object is
/// too small; in a thin primitive, it is too large. A calibration with 4 mm of noise showed no error.
class LabelModel {
 public:
  /// `label_error`: probability that an object tap has the label of the desk. `false_contact`: probability that a desk
  /// tap has the label of an object. Both are in (0, 0.5]. `noise`: standard deviation of positions along x and y,
  /// metres, at least 0.
  LabelModel(double label_error, double false_contact, double noise);

  /// Depth in steps of 2 * reach() / kSteps. kOutside: more than reach() outside; kInside: more than reach() deep.
  using Step = std::uint8_t;
  static constexpr int kSteps = 128;
  static constexpr Step kOutside = 0;
  static constexpr Step kInside = kSteps + 1;
  /// Returns whether the depth is at least 0.
  static bool inside(Step step) { return step > kSteps / 2; }
  /// Returns the step of a depth, metres.
  Step step(double depth) const;
  double steps_per_metre() const { return steps_per_metre_; }
  /// Returns the distance from a rim within which noise matters, metres.
  double reach() const { return reach_; }

  double probability(Step step, bool on) const { return entry(step, on).probability; }
  /// Returns the logarithm of the largest probability of the label minus the logarithm of its probability; at least 0.
  std::int32_t loss(Step step, bool on) const { return losses_[index(step, on)]; }
  /// Returns the sum of the losses of `length` taps; `length` must be a multiple of 8. `labels` has kInside for object
  /// taps and kOutside for desk taps, which are the steps without loss.
  LogUnits loss(const Step* steps, const Step* labels, int length) const;
  /// Returns the probability that the label is an error and not an effect of noise near a rim.
  double wrong(Step step, bool on) const { return entry(step, on).wrong; }
  /// Returns whether the label counts as an error because of its small probability.
  bool contradicts(Step step, bool on) const { return loss(step, on) > contradictions_[on ? 1 : 0]; }

 private:
  struct Entry {
    double probability, wrong;
  };
  static std::size_t index(Step step, bool on) { return 2 * std::size_t{step} + (on ? 1 : 0); }
  const Entry& entry(Step step, bool on) const { return table_[index(step, on)]; }

  double reach_;
  double steps_per_metre_;
  std::array<LogUnits, 2> contradictions_;  ///< half of the loss of a wrong desk label, and of a wrong object label
  std::vector<Entry> table_;
  std::vector<std::int32_t> losses_;
};

/// Probability of the heights of object taps, relative to independent uniform heights. The top of a primitive is level,
/// sloped or arbitrary. On a level or sloped top, a height depends on the height of the nearest earlier tap in the same
/// primitive: a Gaussian process with one neighbour (Vecchia 1988). The first tap of a primitive has an arbitrary
/// height, or continues the height of the nearest earlier tap outside.
class TapHeightModel {
 public:
  /// Adds an object tap.
  void add(const Touch& touch);

  /// Returns the logarithm of the probability. `holders` has one entry per object tap, in order. Bit i is set if
  /// primitive i, of at most 16, contains the tap. A tap in k primitives counts 1/k in each. A push has no effect here.
  LogUnits evidence(const std::vector<std::uint16_t>& holders, int primitives) const;

 private:
  /// Logarithms of a height's probability given an earlier height, on a level and on a sloped top.
  struct Neighbour {
    std::size_t tap;
    LogUnits level, slope;
  };
  struct Tap {
    Touch touch;
    std::vector<Neighbour> neighbours;  ///< nearest first
    LogUnits first = 0;                 ///< logarithm for the first tap of a primitive
  };
  std::vector<Tap> taps_;
};

}  // namespace palpate::footprints
