// SPDX-License-Identifier: MIT
// What a few readings of a force amount to. Newtons.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpate::baxter {

/// The mean of each component.
Eigen::Vector3d average(const std::vector<Eigen::Vector3d>& readings);

/// The median of each component; at least one reading.
Eigen::Vector3d median(std::vector<Eigen::Vector3d> readings);

/// The mean force of a descent from when the arm, which trails its set-point, comes down evenly until shortly after.
/// Where it rises meanwhile a contact begins: that is no force of a moving arm.
class EvenDescent {
 public:
  /// Takes a reading `time` seconds after the set-point began to come down; whether the mean is there now.
  bool add(double time, const Eigen::Vector3d& reading);
  const Eigen::Vector3d& mean() const { return mean_; }

 private:
  bool conclude();

  std::vector<Eigen::Vector3d> readings_;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::baxter
