// SPDX-License-Identifier: MIT
#include "fake_baxter/dynamics.hpp"

#include "baxter/kdl.hpp"
#include "fake_baxter/links.hpp"

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <stdexcept>

namespace palpate::fake_baxter {
namespace {

using namespace baxter::geometry;
using baxter::array_of;
using baxter::frame;

KDL::RigidBodyInertia body(const Link& link) {
  const double* i = link.inertia;
  return KDL::RigidBodyInertia(link.mass, KDL::Vector(link.centre[0], link.centre[1], link.centre[2]),
                               KDL::RotationalInertia(i[0], i[1], i[2], i[3], i[4], i[5]));
}

/// KDL rotates a joint before the fixed part of its segment. The inertia belongs to the frame at the segment's end.
KDL::Chain heavy_arm(const Eigen::Vector3d& tip) {
  KDL::Chain out;
  out.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(kMount) * frame(kSteps[0])));
  for (std::size_t i = 0; i < kLinks.size(); ++i) {
    const bool last = i + 1 == kLinks.size();
    const KDL::Frame hand(KDL::Vector(0, 0, kHand));
    const KDL::Frame end = last ? hand * KDL::Frame(KDL::Vector(tip.x(), tip.y(), tip.z())) : frame(kSteps[i + 1]);
    KDL::RigidBodyInertia inertia = body(kLinks[i]);
    if (last) inertia = inertia + hand * (body(kHandLink) + body(tool_link(tip)));
    out.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), end, end.Inverse() * inertia));
  }
  return out;
}

const KDL::Vector kGravity(0, 0, -9.81);

}  // namespace

Link tool_link(const Eigen::Vector3d& tip) {
  constexpr double kMass = 0.2;     // kg
  constexpr double kRadius = 0.01;  // m
  Link out{"tool", kMass, {tip.x() / 2, tip.y() / 2, tip.z() / 2}, {}};
  const Eigen::Matrix3d along = tip * tip.transpose();
  const Eigen::Matrix3d inertia = kMass / 12 * (tip.squaredNorm() * Eigen::Matrix3d::Identity() - along) +
                                  kMass / 4 * kRadius * kRadius * Eigen::Matrix3d::Identity();
  const int row[] = {0, 1, 2, 0, 0, 1};
  const int column[] = {0, 1, 2, 1, 2, 2};
  for (int i = 0; i < 6; ++i) out.inertia[i] = inertia(row[i], column[i]);
  return out;
}

struct Dynamics::Solvers {
  explicit Solvers(const Eigen::Vector3d& tip)
      : arm(heavy_arm(tip)), forward(arm, kGravity), parameters(arm, kGravity), tangent(arm), where(arm) {}
  KDL::Chain arm;
  KDL::ChainFdSolver_RNE forward;
  KDL::ChainDynParam parameters;
  KDL::ChainJntToJacSolver tangent;
  KDL::ChainFkSolverPos_recursive where;
  KDL::Wrenches none{8, KDL::Wrench::Zero()};
};

Dynamics::Dynamics(const Eigen::Vector3d& tip) : solvers_(std::make_unique<Solvers>(tip)) {}
Dynamics::~Dynamics() = default;
Dynamics::Dynamics(Dynamics&&) noexcept = default;
Dynamics& Dynamics::operator=(Dynamics&&) noexcept = default;

Joints Dynamics::weight(const Joints& joints) const {
  KDL::JntArray out(7);
  solvers_->parameters.JntToGravity(array_of(joints), out);
  return out.data;
}

Dynamics::Inertia Dynamics::inertia(const Joints& joints) const {
  KDL::JntSpaceInertiaMatrix out(7);
  solvers_->parameters.JntToMass(array_of(joints), out);
  return out.data;
}

Joints Dynamics::acceleration(const Joints& joints, const Joints& speed, const Joints& torques) const {
  KDL::JntArray out(7);
  const int trouble =
      solvers_->forward.CartToJnt(array_of(joints), array_of(speed), array_of(torques), solvers_->none, out);
  if (trouble < 0) throw std::runtime_error("the arm's inertia is singular");
  return out.data;
}

Dynamics::Jacobian Dynamics::jacobian(const Joints& joints) const {
  KDL::Jacobian out(7);
  solvers_->tangent.JntToJac(array_of(joints), out);
  return out.data;
}

Eigen::Vector3d Dynamics::tip(const Joints& joints) const {
  KDL::Frame at;
  solvers_->where.JntToCart(array_of(joints), at);
  return {at.p.x(), at.p.y(), at.p.z()};
}

}  // namespace palpate::fake_baxter
