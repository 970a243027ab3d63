// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"

#include "scene/prism.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Lines into a tilted object must point down in its own frame, by more than rounding.
constexpr double kSteepestTilt = 80.0 / 180.0 * 3.14159265358979323846 * (1 + 1e-12);

void list_height(double& height, Fields& fields) {
  fields.real(height, Field("height", "of the top above the desk, upright").in(Unit::metre).above(0));
}

}  // namespace

void AreaOptions::list(Fields& fields) {
  fields.real(width,
              Field("width", "extent along x").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
  fields.real(depth,
              Field("depth", "extent along y").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
}

void WaveOptions::list(Fields& fields) {
  fields.real(length,
              Field("length", "extent along the wave").in(Unit::metre).above(0).from("Sun and Min 2021: 16 cm"));
  fields.real(width, Field("width", "extent across it").in(Unit::metre).above(0).from("Sun and Min 2021: 6 cm"));
  fields.real(height, Field("height", "mean height of the top above the desk").in(Unit::metre).above(0));
  fields.real(amplitude, Field("amplitude", "of the wave, with a crest at the centre").in(Unit::metre).at_least(0));
  fields.real(period, Field("period", "distance from crest to crest").in(Unit::metre).above(0));
  fields.require(amplitude <= height, "amplitude", "is larger than the mean height, the top would dip below the desk");
}

void SlopeOptions::list(Fields& fields) {
  fields.real(length,
              Field("length", "extent along the rise").in(Unit::metre).above(0).from("Sun and Min 2021: 17 cm"));
  fields.real(width, Field("width", "extent across it").in(Unit::metre).above(0).from("Sun and Min 2021: 6 cm"));
  fields.real(low, Field("low", "height above the desk where the rise begins").in(Unit::metre).at_least(0));
  fields.real(high, Field("high", "height where it ends").in(Unit::metre).above(0).from("Sun and Min 2021: 8 cm"));
}

void BlockOptions::list(Fields& fields) {
  fields.real(length, Field("length", "extent along it").in(Unit::metre).above(0));
  fields.real(width, Field("width", "extent across it").in(Unit::metre).above(0));
  list_height(height, fields);
}

void DomeOptions::list(Fields& fields) {
  fields.real(diameter, Field("diameter", "of the outline").in(Unit::metre).above(0));
  list_height(height, fields);
  fields.require(height <= diameter / 2, "height", "is more than half the diameter, which makes half a ball");
}

void CylinderOptions::list(Fields& fields) {
  fields.real(diameter, Field("diameter", "of the outline").in(Unit::metre).above(0));
  list_height(height, fields);
}

void ConeOptions::list(Fields& fields) {
  fields.real(diameter, Field("diameter", "of the outline").in(Unit::metre).above(0));
  list_height(height, fields);
}

void EllipsoidOptions::list(Fields& fields) {
  fields.real(length, Field("length", "extent along it").in(Unit::metre).above(0));
  fields.real(width, Field("width", "extent across it").in(Unit::metre).above(0));
  list_height(height, fields);
}

void BarsOptions::list(Fields& fields) {
  fields.real(length, Field("length", "outer extent along the first bar").in(Unit::metre).above(0));
  fields.real(width, Field("width", "outer extent across it").in(Unit::metre).above(0));
  fields.real(thickness, Field("thickness", "of either bar, seen from above").in(Unit::metre).above(0));
  list_height(height, fields);
  fields.require(thickness < length && thickness < width, "thickness",
                 "is not less than length and width, nothing would be left of the second bar");
}

void RingOptions::list(Fields& fields) {
  fields.real(outer, Field("outer", "diameter of the outline").in(Unit::metre).above(0));
  fields.real(inner, Field("inner", "diameter of the hole").in(Unit::metre).above(0));
  list_height(height, fields);
  fields.require(inner < outer, "inner", "is not less than the outer diameter");
}

void PolygonOptions::list(Fields& fields) {
  fields.table(outline, Field("outline",
                              "corners in their order, along and across; the rectangle around them is centred at `at`")
                            .in(Unit::metre)
                            .needed());
  const std::string trouble = trouble_of_outline(outline);
  fields.require(trouble.empty(), "outline", trouble);
  fields.table(hole, Field("hole", "corners of a hole within the outline; [] for none").in(Unit::metre));
  if (trouble.empty() && !hole.empty()) {
    std::string hole_trouble = trouble_of_outline(hole);
    if (hole_trouble.empty()) hole_trouble = trouble_of_hole(outline, hole);
    fields.require(hole_trouble.empty(), "hole", hole_trouble);
  }
  list_height(height, fields);
}

void ObjectOptions::list(Fields& fields) {
  const auto listed = [](Options& options) { return [&options](Fields& inner) { options.list(inner); }; };
  fields.choice(type, Field("type", "shape of the object").needed(),
                {{"wave", "block with a wavy top", listed(wave)},
                 {"slope", "block with a sloping top", listed(slope)},
                 {"block", "with a flat top", listed(block)},
                 {"dome", "cap of a ball", listed(dome)},
                 {"cylinder", "standing", listed(cylinder)},
                 {"cone", "with its apex up", listed(cone)},
                 {"ellipsoid", "whole, resting on the desk", listed(ellipsoid)},
                 {"l", "two bars that meet at their ends", listed(bars)},
                 {"t", "two bars, the second from the middle of the first", listed(bars)},
                 {"ring", "cylinder with a round hole", listed(ring)},
                 {"polygon", "any outline, raised", listed(polygon)},
                 {"mesh", "triangles from a file", [this](Fields& inner) { inner.adopt(mesh); }},
                 {"plugin", "a shape of your own",
                  [this](Fields& inner) { inner.plugin(plugin, Field("shape", "of the object")); }}});
  fields.reals(
      at, 2,
      Field("at", "x, y of the centre of the rectangle that bounds the outline of the upright object").in(Unit::metre));
  fields.real(rotation,
              Field("rotation", "counter-clockwise about the vertical through `at`, 0 lays the length along x")
                  .in(Unit::radian));
  fields.real(tilt, Field("tilt",
                          "before the rotation, lifts the end of the length about the axis across it; then the "
                          "object is set down with its lowest point on the desk; within 80 deg either way")
                        .in(Unit::radian));
  fields.require(std::abs(tilt) <= kSteepestTilt, "tilt", "is more than 80 deg");
}

void SceneOptions::list(Fields& fields) {
  fields.section(area, Field("area", "the rectangle of the desk in which taps may fall").needed());
  fields.real(desk, Field("desk", "height of the desk").in(Unit::metre));
  fields.real(
      on_surface_above,
      Field("on_surface_above", "a contact higher than the desk plus this is on an object").in(Unit::metre).above(0));
  fields.choice(placement, Field("placement", "where the objects stand"),
                {{"fixed", "at `at`, turned by `rotation`", {}},
                 {"random",
                  "position and rotation of each object from the seed, wholly inside the area, none over another",
                  {}}});
  fields.sections(objects, Field("objects", "what stands on the desk"));
  fields.section(effects, Field("effects", "how taps differ from perfect ones; each is absent by default").group());
}

}  // namespace palpate
