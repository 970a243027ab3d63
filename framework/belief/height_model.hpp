// SPDX-License-Identifier: MIT
// The GP of the heights of all contacts with its maps over the candidates, and the map of the labels.
#pragma once

#include "belief/gp_model.hpp"

#include <Eigen/Core>

#include <utility>

namespace palpate {

/// Maps have one value per candidate (M values), and are empty before the first update.
class HeightModel {
 public:
  /// `has_mean`: whether mean() is computed, because it is the surface (`surface: single`). `desk`: height of the desk,
  /// metres.
  HeightModel(GpModel gp, bool has_mean, double desk) : gp_(std::move(gp)), has_mean_(has_mean), desk_(desk) {}

  GpModel& gp() { return gp_; }
  const GpModel& gp() const { return gp_; }

  /// Updates the maps to the data of the GP. Throws Error for values that are not finite; the message contains `taps`,
  /// the number of taps so far.
  void update_maps(int taps);

  /// Return the variance without noise: uncertainty() relative to the prior, in [0, 1], and variance() in square
  /// metres.
  const Eigen::VectorXd& uncertainty() const { return uncertainty_; }
  const Eigen::VectorXd& variance() const { return variance_; }
  /// Returns the mean, metres, in the frame of the scene.
  const Eigen::VectorXd& mean() const { return mean_; }

 private:
  GpModel gp_;
  bool has_mean_;
  double desk_;
  Eigen::VectorXd uncertainty_, variance_, mean_;
};

/// The map of the label GP. The label GP may be output 1 of the height GP (see height_map_models.hpp).
class LabelMap {
 public:
  /// `clip`: whether weight() is clipped.
  explicit LabelMap(bool clip) : clip_(clip) {}

  /// Reads the map of an output of `process`. Throws Error for values that are not finite; the message contains `taps`,
  /// the number of taps so far.
  void update(const GaussianProcess& process, int output, int taps);

  /// Returns the mean of the labels.
  const Eigen::VectorXd& mean() const { return mean_; }
  /// Returns the mean clipped to [0, 1]: the probability of `footprint: gp_regression`.
  const Eigen::VectorXd& clipped() const { return clipped_; }
  /// Returns the weight w of the acquisition of Sun and Min 2021: the clipped mean if `clip` is set, else the mean.
  const Eigen::VectorXd& weight() const { return clip_ ? clipped_ : mean_; }

 private:
  bool clip_;
  Eigen::VectorXd mean_, clipped_;
};

/// Sets `out` to the posterior mean of output 0 in the frame of the scene, metres. Throws Error for values that are not
/// finite.
void read_surface(const GaussianProcess& process, double desk, int taps, Eigen::VectorXd& out);

}  // namespace palpate
