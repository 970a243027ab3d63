// SPDX-License-Identifier: MIT
// Masses and inertias of the links of Baxter's left arm, from Rethink's baxter.urdf 1.2.0. The positions of its joints
// are in baxter/kinematics.hpp.
#pragma once

#include <Eigen/Core>

#include <array>

namespace palpate::fake_baxter {

/// A rigid body in the frame of the joint that rotates it: metres, kilograms.
struct Link {
  const char* name;
  double mass;
  double centre[3];   ///< of mass
  double inertia[6];  ///< about the centre of mass: xx, yy, zz, xy, xz, yz, kg m^2
};

/// Links from the shoulder to the wrist, one per joint.
constexpr std::array<Link, 7> kLinks = {{
    {"upper_shoulder",
     5.70044,
     {0.01783, 0.00086, 0.19127},
     {0.04709102262, 0.03766976455, 0.03595988478, 0.00012787556, 0.00614870039, 0.00078086899}},
    {"lower_shoulder",
     3.22698,
     {0.06845, 0.00269, -0.00529},
     {0.01175209419, 0.0278859752, 0.02078749298, -0.00030096398, 0.00207675762, -0.00018821993}},
    {"upper_elbow",
     4.31272,
     {-0.00276, 0.00132, 0.18086},
     {0.02661733557, 0.02844355207, 0.01248008322, 0.00029270634, 0.00392189887, 0.0010838933}},
    {"lower_elbow",
     2.07206,
     {0.02611, 0.00159, -0.01117},
     {0.00711582686, 0.01318227876, 0.00926852064, 0.00036036173, 0.0007459496, -0.00019663418}},
    {"upper_forearm",
     2.24665,
     {-0.00168, 0.0046, 0.13952},
     {0.01667742825, 0.01675457264, 0.0037463115, 0.00018403705, 0.00018657629, -0.00064732352}},
    {"lower_forearm",
     1.60979,
     {0.06041, 0.00697, 0.006},
     {0.00387607152, 0.00700537914, 0.0055275524, -0.00044384784, -0.00021115038, 0.00015348067}},
    {"wrist",
     0.35093,
     {0.00198, 0.00125, 0.01855},
     {0.00025289155, 0.0002688601, 0.0003074118, 0.00000575311, -0.00000159345, -0.00000519818}},
}};

/// Hand, in the frame left_hand, which is fixed to the wrist.
constexpr Link kHandLink = {"hand",
                            0.19125,
                            {0.01093, 0.00042, -0.01532},
                            {0.00017588, 0.00021166377, 0.00023745397, 0.00000147073, 0.0000243633, 0.00000172689}};

/// Returns the tool: a rod from the flange to the tip, in the frame left_hand.
Link tool_link(const Eigen::Vector3d& tip);

}  // namespace palpate::fake_baxter
