// SPDX-License-Identifier: MIT
#include "baxter/kinematics.hpp"

#include "baxter/kdl.hpp"

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace palpate::baxter {
namespace {

using namespace geometry;

constexpr double kAccuracy = 1e-6;
constexpr int kIterations = 100;
constexpr double kLever = 0.1;  // m: lever that converts a rotation error in rad to a position error

/// KDL rotates a joint before the fixed part of its segment, URDF after it. So each KDL joint gets the transform of the
/// next URDF joint.
KDL::Chain left_arm(const Eigen::Vector3d& tip) {
  KDL::Chain out;
  out.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(kMount) * frame(kSteps[0])));
  for (int i = 1; i < 7; ++i) out.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame(kSteps[i])));
  out.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame(KDL::Vector(tip.x(), tip.y(), kHand + tip.z()))));
  return out;
}

}  // namespace

struct ArmKinematics::Chain {
  explicit Chain(const Eigen::Vector3d& tip) : arm(left_arm(tip)) {}
  KDL::Chain arm;
  KDL::ChainFkSolverPos_recursive forward{arm};
  KDL::ChainJntToJacSolver jacobian{arm};
  KDL::ChainIkSolverPos_LMA inverse{arm, (Eigen::Matrix<double, 6, 1>() << 1, 1, 1, kLever, kLever, kLever).finished(),
                                    kAccuracy, kIterations};
};

ArmKinematics::ArmKinematics(const Eigen::Vector3d& tip) : chain_(std::make_unique<Chain>(tip)) {}
ArmKinematics::~ArmKinematics() = default;

Pose ArmKinematics::tip(const Joints& joints) const {
  KDL::Frame at;
  chain_->forward.JntToCart(array_of(joints), at);
  Pose out;
  out.position = {at.p.x(), at.p.y(), at.p.z()};
  Eigen::Quaterniond& q = out.rotation;
  at.M.GetQuaternion(q.x(), q.y(), q.z(), q.w());
  return out;
}

double ArmKinematics::vertical_stiffness(const Joints& joints) const {
  KDL::Jacobian jacobian(7);
  chain_->jacobian.JntToJac(array_of(joints), jacobian);
  double give = 0.0;  // m/N
  for (int i = 0; i < 7; ++i) give += jacobian.data(2, i) * jacobian.data(2, i) / kSprings[i];
  return 1.0 / give;
}

std::optional<Joints> ArmKinematics::solve(const Pose& tip, const Joints& seed, double margin) const {
  const Eigen::Quaterniond& q = tip.rotation;
  const KDL::Frame goal(KDL::Rotation::Quaternion(q.x(), q.y(), q.z(), q.w()),
                        KDL::Vector(tip.position.x(), tip.position.y(), tip.position.z()));
  KDL::JntArray found(7);
  if (chain_->inverse.CartToJnt(array_of(seed), goal, found) < 0) return std::nullopt;
  const Joints out = found.data;
  if (!out.allFinite() || beyond_limits(out, margin) >= 0) return std::nullopt;
  return out;
}

Joints lower_limits() {
  return (Joints() << -1.70167993878, -2.147, -3.05417993878, -0.05, -3.059, -1.57079632679, -3.059).finished();
}

Joints upper_limits() {
  return (Joints() << 1.70167993878, 1.047, 3.05417993878, 2.618, 3.059, 2.094, 3.059).finished();
}

Joints untucked() { return (Joints() << -0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.50).finished(); }

const Eigen::Quaterniond& straight_down() {
  // The untucked rotation without its tilt.
  static const Eigen::Quaterniond rotation = [] {
    const Eigen::Quaterniond hand = ArmKinematics(Eigen::Vector3d::Zero()).tip(untucked()).rotation;
    return Eigen::Quaterniond(0.0, hand.x(), hand.y(), 0.0).normalized();
  }();
  return rotation;
}

int beyond_limits(const Joints& joints, double margin) {
  for (int i = 0; i < 7; ++i) {
    if (!(joints(i) >= lower_limits()(i) + margin && joints(i) <= upper_limits()(i) - margin)) return i;
  }
  return -1;
}

}  // namespace palpate::baxter
