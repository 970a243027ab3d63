// SPDX-License-Identifier: MIT
// The likelihood of a hypothesis: the probability of the labels of the taps, and of their heights. Logarithms are whole
// numbers in units of 2^-20, so that sums have the same bytes in any order.
#pragma once

#include <palpate/footprint.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// A natural logarithm in units of 2^-20, and the conversion from and to a real number.
using LogUnits = std::int64_t;
LogUnits to_units(double logarithm);
inline double from_units(LogUnits units) { return static_cast<double>(units) * 0x1p-20; }

/// The probability of the label of a tap, given its depth in a hypothesis: the depth in the deepest primitive. With two
/// rims within the noise this is an approximation. The union of two primitives is deeper there, and a thin primitive
/// less deep. No error was seen in the calibration with 4 mm of noise.
class LabelModel {
 public:
  /// `label_error`: probability that a tap of an object has the label of the desk. `false_contact`: probability that a
  /// tap of the desk has the label of an object; both in (0, 0.5]. `noise`: standard deviation of positions along x and
  /// y, metres, not negative.
  LabelModel(double label_error, double false_contact, double noise);

  /// A depth in steps of 2 * reach() / kSteps. kOutside: farther outside than reach(); kInside: deeper than reach().
  using Step = std::uint8_t;
  static constexpr int kSteps = 128;
  static constexpr Step kOutside = 0;
  static constexpr Step kInside = kSteps + 1;
  /// Whether the depth is not negative.
  static bool inside(Step step) { return step > kSteps / 2; }
  /// Returns the step of a depth, metres.
  Step step(double depth) const;
  double steps_per_metre() const { return steps_per_metre_; }
  /// The distance from a rim within which noise matters, metres.
  double reach() const { return reach_; }

  double probability(Step step, bool on) const { return entry(step, on).probability; }
  /// The logarithm of the largest probability of such a label minus that of its probability; not negative.
  std::int32_t loss(Step step, bool on) const { return losses_[index(step, on)]; }
  /// Returns the sum of the losses of `length` taps, a multiple of 8. `labels`: kInside for taps with the label of an
  /// object, otherwise kOutside, which are the steps without a loss.
  LogUnits loss(const Step* steps, const Step* labels, int length) const;
  /// The probability that the label is an error, rather than due to noise near a rim.
  double wrong(Step step, bool on) const { return entry(step, on).wrong; }
  /// Whether the label counts as a label error, because its probability is small.
  bool contradicts(Step step, bool on) const { return loss(step, on) > contradictions_[on ? 1 : 0]; }

 private:
  struct Entry {
    double probability, wrong;
  };
  static std::size_t index(Step step, bool on) { return 2 * std::size_t{step} + (on ? 1 : 0); }
  const Entry& entry(Step step, bool on) const { return table_[index(step, on)]; }

  double reach_;
  double steps_per_metre_;
  std::array<LogUnits, 2> contradictions_;  ///< half of the loss of a wrong label of the desk, and of an object
  std::vector<Entry> table_;
  std::vector<std::int32_t> losses_;
};

/// The probability of the heights of the object taps, relative to independent uniform heights. The top of a primitive
/// is level, sloped or of any form. On a level or sloped top a height depends on that of the nearest earlier tap in the
/// same primitive: a Gaussian process with one neighbour (Vecchia 1988). The first tap of a primitive has any height,
/// or that of the nearest earlier tap outside.
class HeightModel {
 public:
  /// Adds a tap of an object.
  void add(const Touch& touch);

  /// Returns the logarithm of the probability. `holders` has an entry for each object tap, in their order: bit i is set
  /// if primitive i, of 16 at most, contains the tap. A tap in k primitives counts 1/k in each. A push moves no tap
  /// here.
  LogUnits evidence(const std::vector<std::uint16_t>& holders, int primitives) const;

 private:
  /// Logarithms of the probability of a height given an earlier one, on a level and on a sloped top.
  struct Neighbour {
    std::size_t tap;
    LogUnits level, slope;
  };
  struct Tap {
    Touch touch;
    std::vector<Neighbour> neighbours;  ///< nearest first
    LogUnits first = 0;                 ///< the logarithm as the first tap of a primitive
  };
  std::vector<Tap> taps_;
};

}  // namespace palpate::footprints
