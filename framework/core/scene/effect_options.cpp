// SPDX-License-Identifier: MIT
// The part `scene.effects:` of a config.
#include "scene/scene_options.hpp"

namespace palpate {
namespace {

void list(ForceNoise& effect, Fields& fields) {
  fields.real(effect.deviation,
              Field("deviation", "standard deviation of a sample; 100 samples a second")
                  .in(Unit::newton)
                  .at_least(0)
                  .from("1.5 N: assumed for Baxter's estimate from its joint springs; none published"));
}

void list(ForceDrift& effect, Fields& fields) {
  fields.real(
      effect.per_metre,
      Field("per_metre", "standard deviation of the slope at which the zero wanders, drawn anew for each tap")
          .in(Unit::newton_per_metre)
          .at_least(0)
          .from("10 N/m: 1.5 N over a descent, an estimate; the zero of Baxter's wrench changes with its pose"));
}

void list(Stiffness& effect, Fields& fields) {
  fields.real(effect.object, Field("object", "force over the depth to which the tip sinks in: 10 N at 1500 N/m, 7 mm")
                                 .in(Unit::newton_per_metre)
                                 .above(0)
                                 .from("1500 N/m: a contact of the order that reproduces Baxter's tapping errors"));
  fields.real(effect.desk, Field("desk", "the same of the desk; without it the desk is as soft as an object")
                               .in(Unit::newton_per_metre)
                               .above(0));
  fields.real(effect.arm, Field("arm", "force over the way that the joints give; the measured pose does not suffer")
                              .in(Unit::newton_per_metre)
                              .above(0));
}

void list(JointLag& effect, Fields& fields) {
  fields.real(effect.delay, Field("delay", "the arm trails its set-point by this times its speed")
                                .in(Unit::second)
                                .at_least(0)
                                .at_most(10)
                                .from("0.3-0.4 s: measured on a Baxter at 0.12 to 0.5 rad/s"));
  fields.real(effect.overshoot, Field("overshoot", "how far a step is overshot, as a share of it; 0 does not overshoot")
                                    .at_least(0)
                                    .at_most(0.9)
                                    .from("0: Baxter's arm creeps up to its set-point"));
}

void list(Latency& effect, Fields& fields) {
  fields.real(effect.deviation,
              Field("deviation", "the force of a tap is heard late by the absolute value of a normal number of this")
                  .in(Unit::second)
                  .at_least(0)
                  .at_most(0.1)
                  .from("15 ms: one or two messages at 100 Hz, an estimate"));
}

void list(HeightOffset& effect, Fields& fields) {
  fields.real(effect.constant,
              Field("constant", "added to every height").in(Unit::metre).from("0: set what is to be tried"));
  fields.real(effect.drift, Field("drift", "added for each second of the arm's time")
                                .in(Unit::metre_per_second)
                                .from("0: an arm that warms up drifts by the order of 1 mm/min, an estimate"));
}

void list(ForeignObjects& effect, Fields& fields) {
  fields.real(effect.probability,
              Field("probability", "share of the squares").at_least(0).at_most(1).from("2 %: as false contacts"));
  fields.real(effect.height, Field("height", "the most that it adds; a uniform share of it, drawn for each square")
                                 .in(Unit::metre)
                                 .above(0)
                                 .from("3 cm: a cable, a chip or a tool left behind, an estimate"));
  fields.real(effect.size, Field("size", "side of a square")
                               .in(Unit::metre)
                               .above(0)
                               .from("1 cm: two cells of the candidates, so that a touch beside may meet the same"));
}

void list(TipRadius& effect, Fields& fields) {
  fields.real(effect.radius, Field("radius", "of the sphere at the end of the tool")
                                 .in(Unit::metre)
                                 .above(0)
                                 .at_most(0.1)
                                 .from("5 mm: a fingertip-like probe, an estimate"));
}

void list(PoseNoise& effect, Fields& fields) {
  fields.real(effect.lateral, Field("lateral", "standard deviation of the place, along x and along y")
                                  .in(Unit::metre)
                                  .at_least(0)
                                  .from("2 mm: relative; objects are localised to 2 mm with Baxter, absolute 2-10 mm"));
  fields.real(effect.vertical,
              Field("vertical", "standard deviation of the height")
                  .in(Unit::metre)
                  .at_least(0)
                  .from("1 mm: settled joint errors of 0.004 rad, most of them alike from tap to tap"));
}

void list(MissedContacts& effect, Fields& fields) {
  fields.real(effect.probability, Field("probability", "per tap, that no force is felt all the way down")
                                      .at_least(0)
                                      .at_most(1)
                                      .from("2 %: an estimate"));
}

void list(FalseContacts& effect, Fields& fields) {
  fields.real(effect.probability, Field("probability", "per tap, of a jerk on the way down that feels like a contact")
                                      .at_least(0)
                                      .at_most(1)
                                      .from("2 %: an estimate"));
}

void list(Reach& effect, Fields& fields) {
  fields.reals(effect.base, 2,
               Field("base", "place of the shoulder: x, y in the frame of the area")
                   .in(Unit::metre)
                   .from("an area whose near edge is 55 cm in front of the arm"));
  fields.real(effect.radius, Field("radius", "of the reach; places farther from the base fail as unreachable")
                                 .in(Unit::metre)
                                 .above(0)
                                 .from("Baxter with its tool straight down: gaps from 0.70 m, half of all at 0.80 m"));
}

void list(Shaft& effect, Fields& fields) {
  fields.real(effect.radius, Field("radius", "of the tool's shaft")
                                 .in(Unit::metre)
                                 .above(0)
                                 .at_most(0.2)
                                 .from("1.5 cm: a gripper's finger, an estimate"));
  fields.real(effect.length, Field("length", "from the tip to where the shaft begins")
                                 .in(Unit::metre)
                                 .above(0)
                                 .from("8 cm: less than the paper's objects are high, an estimate"));
}

void list(Push& effect, Fields& fields) {
  fields.real(
      effect.probability,
      Field("probability", "after each tap, that an object is pushed").at_least(0).at_most(1).from("2 %: an estimate"));
  fields.real(effect.distance, Field("distance", "by which an object is pushed, in some direction")
                                   .in(Unit::metre)
                                   .at_least(0)
                                   .from("5 mm: what 10 N do to a light object on a smooth desk, an estimate"));
  fields.real(effect.turn, Field("turn", "by up to which it is turned, either way")
                               .in(Unit::radian)
                               .at_least(0)
                               .from("5 degrees: an estimate"));
  fields.integer(
      effect.after,
      Field("after", "the only tap after which anything is pushed").at_least(1).from("none: set it to try one push"));
}

/// An effect as a group of options.
template <class Effect>
struct Group : Options {
  Effect effect;
  void list(Fields& fields) override { palpate::list(effect, fields); }
};

/// An effect that may be absent.
template <class Effect>
void section(Fields& fields, std::optional<Effect>& effect, const Field& field) {
  bool present = effect.has_value();
  Group<Effect> group;
  group.effect = effect.value_or(Effect{});
  fields.section(present, group, field);
  effect = present ? std::optional(group.effect) : std::nullopt;
}

}  // namespace

void EffectOptions::list(Fields& fields) {
  section(fields, values.force_noise, Field("force_noise", "white noise of the force sensor"));
  section(fields, values.force_drift, Field("force_drift", "the force sensor's zero wanders during the descent"));
  section(fields, values.stiffness, Field("stiffness", "the object, and the arm, give way"));
  section(fields, values.joint_lag,
          Field("joint_lag", "the arm trails what it is told; what it presses with is true only beside stiffness"));
  section(fields, values.latency, Field("latency", "the force is heard late, by another time at each tap"));
  section(fields, values.height_offset, Field("height_offset", "all heights are off, and drift"));
  section(fields, values.foreign_objects,
          Field("foreign_objects", "objects that are not of the scene; they stay where they are"));
  section(fields, values.tip_radius, Field("tip_radius", "the tip is a sphere: it meets the side of a step first"));
  section(fields, values.pose_noise, Field("pose_noise", "the tip is not quite where the joints say"));
  section(fields, values.missed_contacts, Field("missed_contacts", "contacts that are not felt"));
  section(fields, values.false_contacts, Field("false_contacts", "contacts in the air"));
  section(fields, values.reach, Field("reach", "places that the arm cannot reach"));
  section(fields, values.push, Field("push", "objects are pushed about: the truth is where they stand"));
  section(fields, values.shaft, Field("shaft", "the tool's shaft touches tall objects beside the tip"));
}

}  // namespace palpate
