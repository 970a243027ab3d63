// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: how much one wants to tap each candidate next.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// What is believed after the taps so far, over the candidates. A map is computed when it is first read after a tap,
/// and the process behind it is built when a map of it is first read at all: a strategy pays for what it reads.
/// References stay valid until the next tap. M is the number of candidates.
class Belief {
 public:
  virtual ~Belief() = default;

  /// M x 2, metres. Fixed for the whole run; ties are broken by the lowest row.
  virtual const Points& candidates() const = 0;
  virtual Area area() const = 0;

  /// Taps made so far, failed ones included, and how many of them the initial design chose.
  virtual int taps() const = 0;
  virtual int initial_taps() const = 0;

  /// u: variance of the height process relative to its prior, noise excluded; M values in [0, 1].
  virtual const Eigen::VectorXd& uncertainty() const = 0;
  /// w: mean of the weight process, or that mean clipped to [0, 1] if the config says `weight: {clip: true}`.
  /// Unclipped it leaves [0, 1] in nearly every run.
  virtual const Eigen::VectorXd& weight() const = 0;
  /// Mean of the height process, metres.
  virtual const Eigen::VectorXd& height_mean() const = 0;
  /// Variance of the height process, noise excluded, square metres.
  virtual const Eigen::VectorXd& height_variance() const = 0;
};

/// Scores that are a product of maps of the belief. The posterior can form these itself while it updates the maps.
enum class Product {
  none,         ///< something else
  uncertainty,  ///< u
  weighted,     ///< u w
};

/// Laws, checked by the contract tests: the score is a pure function of the belief (same belief, same bytes; no clock,
/// no state), finite, and fills every candidate.
class Acquisition {
 public:
  static constexpr const char* kKind = "acquisition";

  virtual ~Acquisition() = default;

  /// Scores all candidates at once; `out` has M elements. The candidate of the highest score is tapped next.
  virtual void score(const Belief& belief, VectorOut out) const = 0;

  /// If score() is nothing but such a product, which one; score() need not be called then.
  virtual Product product() const { return Product::none; }

  /// The size of a typical score before any tap: the unit in which ties are judged when scores become small.
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
