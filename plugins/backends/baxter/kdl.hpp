// SPDX-License-Identifier: MIT
// Conversions from the driver's types to those of KDL.
#pragma once

#include "baxter/kinematics.hpp"

#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>

namespace palpate::baxter {

inline KDL::Frame frame(const geometry::JointTransform& step) {
  return {KDL::Rotation::RPY(step.roll, step.pitch, step.yaw), KDL::Vector(step.x, step.y, step.z)};
}

inline KDL::JntArray array_of(const Joints& joints) {
  KDL::JntArray out(7);
  out.data = joints;
  return out;
}

}  // namespace palpate::baxter
