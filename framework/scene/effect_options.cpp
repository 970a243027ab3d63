// SPDX-License-Identifier: MIT
// The options of `scene.effects:` in a config: one list per effect.
#include "scene/scene_options.hpp"

namespace palpate {
namespace {

void list(ForceNoise& effect, Fields& fields) {
  fields.real(effect.deviation,
              Field("deviation", "standard deviation of one force sample. The sensor delivers 100 samples per second")
                  .in(Unit::newton)
                  .at_least(0)
                  .from("1.5 N: assumed for Baxter's estimate from its joint springs; none published"));
}

void list(ForceDrift& effect, Fields& fields) {
  fields.real(
      effect.per_metre,
      Field("per_metre",
            "standard deviation of the force sensor's zero drift per metre of descent. The drift is drawn for each tap")
          .in(Unit::newton_per_metre)
          .at_least(0)
          .from("10 N/m: 1.5 N over a descent, an estimate; the zero of Baxter's wrench changes with its pose"));
}

void list(Stiffness& effect, Fields& fields) {
  fields.real(effect.object, Field("object",
                                   "contact stiffness of the object (force per depth of penetration). For example, 10 "
                                   "N at 1500 N/m cause a depth of 7 mm")
                                 .in(Unit::newton_per_metre)
                                 .above(0)
                                 .from("1500 N/m: a contact of the order that reproduces Baxter's tapping errors"));
  fields.real(effect.desk, Field("desk", "contact stiffness of the desk; not given: the stiffness of the object")
                               .in(Unit::newton_per_metre)
                               .above(0));
  fields.real(effect.arm,
              Field("arm", "stiffness of the arm's joints. The joint deflection does not change the measured pose")
                  .in(Unit::newton_per_metre)
                  .above(0));
}

void list(JointLag& effect, Fields& fields) {
  fields.real(
      effect.delay,
      Field("delay", "time lag of the arm. The arm trails the set-point by this time multiplied by the arm's speed")
          .in(Unit::second)
          .within(0, 10)
          .from("0.3-0.4 s: measured on a Baxter at 0.12 to 0.5 rad/s"));
  fields.real(effect.overshoot, Field("overshoot", "overshoot as a share of the step; 0 for no overshoot")
                                    .within(0, 0.9)
                                    .from("0: Baxter's arm creeps up to its set-point"));
}

void list(Latency& effect, Fields& fields) {
  fields.real(effect.deviation, Field("deviation",
                                      "scale of the force signal's delay. For each tap, the delay is the absolute "
                                      "value of a normal variable with this standard deviation")
                                    .in(Unit::second)
                                    .within(0, 0.1)
                                    .from("15 ms: one or two messages at 100 Hz, an estimate"));
}

void list(HeightOffset& effect, Fields& fields) {
  fields.real(effect.constant, Field("constant", "constant offset added to every height")
                                   .in(Unit::metre)
                                   .from("0: set the offset that you want to test"));
  fields.real(effect.drift, Field("drift", "offset added to every height per second of robot time")
                                .in(Unit::metre_per_second)
                                .from("0: an arm that warms up drifts by the order of 1 mm/min, an estimate"));
}

void list(ForeignObjects& effect, Fields& fields) {
  fields.real(effect.probability,
              Field("probability", "share of the grid squares of the area that hold a foreign object")
                  .within(0, 1)
                  .from("2 %: as false contacts"));
  fields.real(
      effect.height,
      Field("height", "maximum height of a foreign object. Each height is drawn uniformly between 0 and this maximum")
          .in(Unit::metre)
          .above(0)
          .from("3 cm: a cable, a chip or a tool left behind, an estimate"));
  fields.real(effect.size, Field("size", "side length of a grid square")
                               .in(Unit::metre)
                               .above(0)
                               .from("1 cm: two candidate cells, so that a neighbouring tap may meet the same object"));
}

void list(TipRadius& effect, Fields& fields) {
  fields.real(effect.radius, Field("radius", "radius of the spherical tip of the tool")
                                 .in(Unit::metre)
                                 .above(0)
                                 .at_most(0.1)
                                 .from("5 mm: a fingertip-like probe, an estimate"));
}

void list(PoseNoise& effect, Fields& fields) {
  fields.real(effect.lateral, Field("lateral", "standard deviation of the tip's measured position, along x and along y")
                                  .in(Unit::metre)
                                  .at_least(0)
                                  .from("2 mm: relative; objects are localised to 2 mm with Baxter, absolute 2-10 mm"));
  fields.real(effect.vertical,
              Field("vertical", "standard deviation of the tip's measured height")
                  .in(Unit::metre)
                  .at_least(0)
                  .from("1 mm: joint errors at rest of 0.004 rad, most of which are the same in every tap"));
}

void list(MissedContacts& effect, Fields& fields) {
  fields.real(effect.probability,
              Field("probability", "probability per tap that no force is felt during the whole descent")
                  .within(0, 1)
                  .from("2 %: an estimate"));
}

void list(FalseContacts& effect, Fields& fields) {
  fields.real(
      effect.probability,
      Field("probability", "probability per tap of a false contact in free air, caused by a jerk during the descent")
          .within(0, 1)
          .from("2 %: an estimate"));
}

void list(Reach& effect, Fields& fields) {
  fields.reals(effect.base, 2,
               Field("base", "x, y of the arm's shoulder in the frame of the area")
                   .in(Unit::metre)
                   .from("an area whose near edge is 55 cm in front of the arm"));
  fields.real(effect.radius,
              Field("radius", "maximum distance of a tap from the base. Taps beyond this distance fail as unreachable")
                  .in(Unit::metre)
                  .above(0)
                  .from("Baxter with its tool straight down: gaps from 0.70 m, half of all at 0.80 m"));
}

void list(Shaft& effect, Fields& fields) {
  fields.real(effect.radius, Field("radius", "radius of the tool's shaft")
                                 .in(Unit::metre)
                                 .above(0)
                                 .at_most(0.2)
                                 .from("1.5 cm: a gripper's finger, an estimate"));
  fields.real(effect.length, Field("length", "distance from the tip to the lower end of the shaft")
                                 .in(Unit::metre)
                                 .above(0)
                                 .from("8 cm: less than the paper's objects are high, an estimate"));
}

void list(Push& effect, Fields& fields) {
  fields.real(
      effect.probability,
      Field("probability", "probability that an object is pushed after a tap").within(0, 1).from("2 %: an estimate"));
  fields.real(effect.distance, Field("distance", "distance by which an object is pushed, in a random direction")
                                   .in(Unit::metre)
                                   .at_least(0)
                                   .from("5 mm: what 10 N do to a light object on a smooth desk, an estimate"));
  fields.real(effect.turn, Field("turn", "maximum rotation of a pushed object, clockwise or counter-clockwise")
                               .in(Unit::radian)
                               .at_least(0)
                               .from("5 degrees: an estimate"));
  fields.integer(
      effect.after,
      Field("after", "number of a tap. An object can be pushed only after this tap; not given: after any tap")
          .at_least(1)
          .from("none: set it to try one push"));
}

/// An effect as a group of options.
template <class Effect>
struct EffectGroup : Options {
  Effect effect;
  void list(Fields& fields) override { palpate::list(effect, fields); }
};

/// Lists an optional effect as a group that may be absent.
template <class Effect>
void section(Fields& fields, std::optional<Effect>& effect, const Field& field) {
  bool present = effect.has_value();
  EffectGroup<Effect> group;
  group.effect = effect.value_or(Effect{});
  fields.section(present, group, field);
  effect = present ? std::optional(group.effect) : std::nullopt;
}

}  // namespace

void EffectOptions::list(Fields& fields) {
  section(fields, values.force_noise, Field("force_noise", "white noise of the force sensor"));
  section(fields, values.force_drift, Field("force_drift", "drift of the force sensor's zero during the descent"));
  section(fields, values.stiffness, Field("stiffness", "compliance of objects, desk and arm"));
  section(fields, values.joint_lag,
          Field("joint_lag",
                "lag of the arm behind its set-point. The contact force is realistic only if `stiffness` is also set"));
  section(fields, values.latency, Field("latency", "delay of the force signal, drawn for each tap"));
  section(fields, values.height_offset, Field("height_offset", "constant offset and drift of all measured heights"));
  section(fields, values.foreign_objects,
          Field("foreign_objects", "unexpected objects at fixed positions that are not part of the scene"));
  section(fields, values.tip_radius,
          Field("tip_radius",
                "spherical tool tip instead of a point. The side of the sphere may touch an edge before the lowest "
                "point touches"));
  section(fields, values.pose_noise,
          Field("pose_noise", "difference between the true and the measured position of the tip"));
  section(fields, values.missed_contacts, Field("missed_contacts", "contacts that the arm does not feel"));
  section(fields, values.false_contacts, Field("false_contacts", "contacts reported in free air"));
  section(fields, values.reach, Field("reach", "limited reach of the arm"));
  section(fields, values.push,
          Field("push", "displacement of objects by taps. Errors are computed at the current position of the objects"));
  section(fields, values.shaft, Field("shaft", "contact of the tool's shaft with tall objects next to the tip"));
}

}  // namespace palpate
