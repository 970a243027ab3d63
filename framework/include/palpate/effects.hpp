// SPDX-License-Identifier: MIT
// How a scene's taps differ from perfect ones: `scene.effects` of a config. Each effect is absent unless the config has
// it, and what is absent is not modelled at all. Only simulators read this, and the belief from any
// side how round the tip is; a robot brings effects of its own.
#pragma once

#include <cstdint>
#include <optional>

namespace palpate {

/// White noise on each sample of the force, newtons (standard deviation).
struct ForceNoise {
  double deviation = 1.5;
};

/// The zero of the force sensor wanders as the arm comes down: by a slope, newtons per metre, that each tap draws anew
/// from a normal distribution of this deviation. A tare at the start of the descent cannot see it.
struct ForceDrift {
  double per_metre = 10.0;
};

/// What is touched gives way under the tool, and the arm's joints under the force: newtons per metre. The measured pose
/// sees the first, as a contact that lies too low, and not the second. A desk without a value is as soft as an object,
/// an arm without one is rigid.
struct Stiffness {
  double object = 1500.0;
  std::optional<double> desk;
  std::optional<double> arm;
};

/// The arm trails its set-point: by `delay` seconds times the speed while it moves, and when the set-point stops short
/// it overshoots by that share of the step.
struct JointLag {
  double delay = 0.35;
  double overshoot = 0.0;
};

/// The force is heard late, by a time that each tap draws anew: seconds, the absolute value of a normal number of this
/// deviation. By then the tip is lower, by the time times the speed of the descent.
struct Latency {
  double deviation = 0.015;
};

/// Heights are off by `constant`, metres, and by `drift` metres more with each second of the arm's time.
struct HeightOffset {
  double constant = 0.0;
  double drift = 0.0;
};

/// Something lies there that is not of the scene, a chip or a cable: on a share of the squares of side `size` that the
/// area is divided into, as high as a uniform share of `height` (metres), and just the same at every touch.
struct ForeignObjects {
  double probability = 0.02;
  double height = 0.03;
  double size = 0.01;
};

/// The tip is a sphere of this radius, metres; without this effect it is a point. The reported height is that of the
/// sphere's lowest point.
struct TipRadius {
  double radius = 0.005;
};

/// The tool is not quite where the joints say: standard deviations, metres. `lateral` moves the place of a tap, along x
/// and y alike; `vertical` adds to its height. Drawn anew for each tap.
struct PoseNoise {
  double lateral = 0.002;
  double vertical = 0.001;
};

/// Contacts that the force does not show: the probability, per tap, that the arm feels nothing all the way down.
struct MissedContacts {
  double probability = 0.02;
};

/// Contacts in the air: the probability, per tap, of a jerk somewhere on the way down that feels like a contact.
struct FalseContacts {
  double probability = 0.02;
};

/// What lies farther than `radius` from the arm's `base` cannot be reached: metres, in the frame of the area.
struct Reach {
  double base[2] = {-0.55, 0.115};
  double radius = 0.75;
};

/// The tool's shaft is a cylinder of this radius that begins `length` above the tip, metres: beside a tall object it
/// touches before the tip does, and force alone cannot tell.
struct Shaft {
  double radius = 0.015;
  double length = 0.08;
};

/// Objects do not stay where they are: an object is pushed by `distance` metres in some direction and turned by up to
/// `turn` radians either way, after each tap with `probability`, or after tap number `after` and no other. Which, and
/// where to, is drawn from the seed and the number of the tap, whatever that tap touched: so the scene of a run that is
/// resumed is that of one that was not broken off.
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
};

}  // namespace palpate
