// SPDX-License-Identifier: MIT
#include "fake_baxter/series_elastic.hpp"

#include <Eigen/Cholesky>

namespace palpate::fake_baxter {

const Joints& spring_stiffness() {
  static const Joints stiffness = (Joints() << 843, 843, 843, 843, 250, 250, 250).finished();
  return stiffness;
}

const Joints& spring_damping() {
  // Approximately critical for the load of each joint.
  static const Joints damping = (Joints() << 40, 40, 20, 20, 4, 4, 1).finished();
  return damping;
}

void Motors::put(const Joints& joints) {
  position_ = joints;
  velocity_.setZero();
  each_.clear();
  for (double one : joints) each_.emplace_back(lag_, step_, one);
}

void Motors::follow(const Joints& reference) {
  for (int i = 0; i < 7; ++i) {
    backends::SimulatedAxis& one = each_[static_cast<std::size_t>(i)];
    one.follow(reference(i));
    velocity_(i) = (one.position() - position_(i)) / step_;
    position_(i) = one.position();
  }
}

Joints Motors::torque(const Joints& joints, const Joints& speed, const Joints& weight) const {
  return spring_stiffness().cwiseProduct(position_ - joints) + spring_damping().cwiseProduct(velocity_ - speed) +
         (1.0 - kSag) * weight;
}

Eigen::Vector3d estimate_force(const Eigen::Matrix<double, 6, 7>& jacobian, const Joints& torques) {
  constexpr double kDamping = 1e-2;  // of singular values, which exceed 0.1 in working postures
  Eigen::Matrix<double, 6, 6> square = jacobian * jacobian.transpose();
  square.diagonal().array() += kDamping * kDamping;
  const Eigen::Matrix<double, 6, 1> wrench = square.llt().solve(jacobian * torques);
  return wrench.head<3>();
}

}  // namespace palpate::fake_baxter
