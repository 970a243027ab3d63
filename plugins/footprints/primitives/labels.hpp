// SPDX-License-Identifier: MIT
// What the touches say of an outline: their labels, and how alike the heights are that one piece is to explain.
#pragma once

#include <palpate/footprint.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// What a label says of how far inside of an outline its touch was.
class LabelModel {
 public:
  /// `mistaken`, `lies`: see ParticleSettings; `blur`: standard deviation of a place along x and y, metres.
  LabelModel(double mistaken, double lies, double blur);

  /// Whether it matters how deep a place lies, and not only whether it is inside.
  bool blurs() const { return blurs_; }
  /// How far beyond a rim a place may be for which it matters, metres.
  double reach() const { return reach_; }

  /// Depths (metres; negative: outside) are told apart in steps.
  using Step = std::uint8_t;
  static constexpr int kSteps = 128;  ///< over the depths at which the place decides
  static constexpr Step kOutside = 0;
  static constexpr Step kInside = kSteps + 1;
  /// How depths become steps.
  struct Steps {
    double per_metre;
    Step of(double depth) const {
      const double steps = depth * per_metre + 0.5 * kSteps;
      return static_cast<Step>(static_cast<int>(std::min(std::max(steps, -1.0), 1.0 * kSteps) + 1.0));
    }
  };
  Steps steps() const { return {steps_per_metre_}; }
  Step step(double depth) const { return steps().of(depth); }
  /// Whether a depth is not negative.
  static bool holds(Step step) { return step > kSteps / 2; }

  /// The probability of a label.
  double probability(Step step, bool on) const { return entry(step, on).probability; }
  /// How much it speaks against the outline, natural logarithm: 0 for a label that is right far from the rim.
  double loss(Step step, bool on) const { return entry(step, on).loss; }
  /// The probability that such a label is wrong, and not just on the other side of a rim by the blur of its place.
  double wrong(Step step, bool on) const { return entry(step, on).wrong; }
  /// Whether it speaks so much against the outline that it counts as wrong.
  bool mistake(Step step, bool on) const { return entry(step, on).loss > mistake_; }

 private:
  struct Entry {
    double probability;
    double loss;
    double wrong;
  };
  const Entry& entry(Step step, bool on) const { return table_[2 * static_cast<std::size_t>(step) + (on ? 1 : 0)]; }

  bool blurs_;
  double mistake_;
  double reach_;
  double steps_per_metre_;
  std::vector<Entry> table_;
};

/// How the heights of an object's touches go together. The top of a piece is level, or it has a slope, or it is of any
/// form. A height is about that of the nearest earlier touch that the piece holds as well, the nearer the more so (a
/// Gaussian process given one neighbour each: Vecchia 1988), or any where the top is of any form. The first of a piece
/// is any height, or that of a touch beside it.
class HeightModel {
 public:
  /// A touch of an object, in the order of all touches; its number among them.
  void add(const Touch& touch, std::size_t number);

  /// How much more probable the heights are, all in all, if pieces hold the touches so, than if each were any height: a
  /// natural logarithm. `holders`: bit i of a touch is set where piece i holds it. A touch of several pieces counts in
  /// each for its part.
  double evidence(const std::vector<std::uint16_t>& holders, int pieces) const;

  /// The numbers of all touches of an object.
  const std::vector<std::size_t>& touches() const { return numbers_; }

 private:
  /// How much more probable a height is beside an earlier one, on each kind of top; logarithms, nearest first.
  struct Neighbour {
    std::size_t touch;
    double level, slope;
  };
  std::vector<Touch> touches_;
  std::vector<std::size_t> numbers_;
  std::vector<std::vector<Neighbour>> neighbours_;  ///< of each of them
  std::vector<double> beside_;  ///< how much more probable each is as the first of a piece beside the nearest of them
};

}  // namespace palpate::footprints
