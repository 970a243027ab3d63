// SPDX-License-Identifier: MIT
// Effects that make simulated taps imperfect: `scene.effects` of a config. An effect that the config lacks is not
// simulated. Only simulators read the effects, except that the belief `solids` reads the radius of the tip.
#pragma once

#include <cstdint>
#include <optional>

namespace palpate {

/// White noise on each sample of the force: standard deviation, newtons.
struct ForceNoise {
  double deviation = 1.5;
};

/// Drift of the force sensor's zero during the descent. Each tap draws a slope, newtons per metre, from a normal
/// distribution with this standard deviation. A tare at the start of the descent does not remove the drift.
struct ForceDrift {
  double per_metre = 10.0;
};

/// Stiffness of objects, desk and arm, newtons per metre. A soft surface makes measured heights too low. The bending of
/// the arm does not appear in the measured pose. A desk without a value is as stiff as an object, an arm without a
/// value is rigid.
struct Stiffness {
  double object = 1500.0;
  std::optional<double> desk;
  std::optional<double> arm;
};

/// Lag of the arm behind its set-point: `delay` seconds times the speed during a motion. After a sudden step of the
/// set-point, the arm overshoots by `overshoot` times the size of the step.
struct JointLag {
  double delay = 0.35;
  double overshoot = 0.0;
};

/// Delay of the force signal, seconds. Each tap draws the absolute value of a normal number with this standard
/// deviation. During the delay, the tip descends further, by the delay times its speed.
struct Latency {
  double deviation = 0.015;
};

/// Error of all heights: `constant`, metres, plus `drift`, metres per second of robot time.
struct HeightOffset {
  double constant = 0.0;
  double drift = 0.0;
};

/// Things that are not part of the scene, such as a chip or a cable. The area is divided into squares of side `size`
/// (metres), and each square has such a thing with `probability`. The heights of these things are uniform up to
/// `height` (metres), and the same at every tap.
struct ForeignObjects {
  double probability = 0.02;
  double height = 0.03;
  double size = 0.01;
};

/// Radius of the spherical tip, metres; without this effect the tip is a point. The reported height is the height of
/// the sphere's lowest point.
struct TipRadius {
  double radius = 0.005;
};

/// Error of the tool's pose per tap: standard deviations, metres. `lateral` moves the position along x and y;
/// `vertical` is added to the height.
struct PoseNoise {
  double lateral = 0.002;
  double vertical = 0.001;
};

/// Contacts that the force does not show: probability per tap that the arm detects no contact at all.
struct MissedContacts {
  double probability = 0.02;
};

/// False contacts in the air: probability per tap of a force peak during the descent.
struct FalseContacts {
  double probability = 0.02;
};

/// Reach of the arm: positions farther than `radius` from its `base` are unreachable; metres, in the frame of the area.
struct Reach {
  double base[2] = {-0.55, 0.115};
  double radius = 0.75;
};

/// Shaft of the tool: a cylinder of this radius that begins `length` above the tip, metres. Beside a tall object the
/// shaft makes contact before the tip, which the force does not show.
struct Shaft {
  double radius = 0.015;
  double length = 0.08;
};

/// Pushes of objects: an object moves by `distance` metres in a random direction and turns by up to `turn` radians. A
/// push follows each tap with `probability`, or only tap number `after`. Object and direction depend on the seed and
/// the number of the tap only, so a resumed run has the same scene.
struct Push {
  double probability = 0.02;
  double distance = 0.005;
  double turn = 0.087;
  std::optional<std::int64_t> after;
};

/// The effects of a scene.
struct Effects {
  std::optional<ForceNoise> force_noise;
  std::optional<ForceDrift> force_drift;
  std::optional<Stiffness> stiffness;
  std::optional<JointLag> joint_lag;
  std::optional<Latency> latency;
  std::optional<HeightOffset> height_offset;
  std::optional<ForeignObjects> foreign_objects;
  std::optional<TipRadius> tip_radius;
  std::optional<PoseNoise> pose_noise;
  std::optional<MissedContacts> missed_contacts;
  std::optional<FalseContacts> false_contacts;
  std::optional<Reach> reach;
  std::optional<Shaft> shaft;
  std::optional<Push> push;

  /// Returns whether taps are perfect: none of the effects above is present.
  bool empty() const {
    return !(force_noise || force_drift || stiffness || joint_lag || latency || height_offset || foreign_objects ||
             tip_radius || pose_noise || missed_contacts || false_contacts || reach || shaft || push);
  }
};

}  // namespace palpate
