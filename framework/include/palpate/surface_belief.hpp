// SPDX-License-Identifier: MIT
// What the taps so far say of surfaces in space, as plugins see it where the tool comes from any side.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// What is believed after the taps so far, over the approaches among which the next is chosen: N of them, drawn anew
/// before every tap, half of them anywhere through the region, half along normals of the surface that is believed.
/// References stay valid until the next tap.
class SurfaceBelief {
 public:
  virtual ~SurfaceBelief() = default;

  virtual const std::vector<Approach>& approaches() const = 0;

  /// Taps made so far, failed ones included.
  virtual int taps() const = 0;

  /// N: how far the tool is expected to come, by the most probable composition: to an object, to the desk, or to the
  /// end of the approach, metres.
  virtual const Eigen::VectorXd& way() const = 0;

  /// N: what a tap is expected to find that nobody has touched yet, metres, were one piece more expected a priori than
  /// is believed: the probability that there is one which no touch so far contradicts and which the approach meets
  /// before all that is believed, times how far it moves the surface: the mean over lines from all sides of how much
  /// earlier they are met, of which no line counts more than 3 cm.
  virtual const Eigen::VectorXd& expected_discovery() const = 0;

  /// N: by how much a tap is expected to lower what is not known of the surface that is believed, metres: its standard
  /// deviation, the mean over all of it, by what the tap tells of where it is met and of all that hangs together with
  /// that; 0 for approaches that meet no object, or meet it at less than 30 degrees.
  virtual const Eigen::VectorXd& std_reduction() const = 0;

  /// N: the standard deviation of the surface where the most probable composition has an approach meet it, along its
  /// normal there, metres; 0 where it meets no object.
  virtual const Eigen::VectorXd& deviation() const = 0;

  /// N: the cosine between approach and normal there, in [0, 1]; 0 where it meets no object.
  virtual const Eigen::VectorXd& incidence_cosine() const = 0;
};

}  // namespace palpate
