// SPDX-License-Identifier: MIT
// What the taps so far say, as plugins see it.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// What is believed after the taps so far, over the candidates. A map is computed when it is first read after a tap,
/// and the process behind it is built when a map of it is first read at all: who reads pays for what is read.
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
  /// p: the probability that a candidate is on an object, by the config's footprint; M values in [0, 1].
  virtual const Eigen::VectorXd& probability() const = 0;
  /// Mean of the height process, metres.
  virtual const Eigen::VectorXd& height_mean() const = 0;
  /// Variance of the height process, noise excluded, square metres.
  virtual const Eigen::VectorXd& height_variance() const = 0;
};

}  // namespace palpate
