// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Lines into a tilted object must point down in its own frame, by more than rounding.
constexpr double kSteepestTilt = 80.0 / 180.0 * 3.14159265358979323846 * (1 + 1e-12);

}  // namespace

void AreaOptions::list(Fields& fields) {
  fields.real(width,
              Field("width", "extent along x").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
  fields.real(depth,
              Field("depth", "extent along y").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
}

void ObjectOptions::list(Fields& fields) {
  fields.adopt(shape, Field("type", "shape of the object").needed());
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
      min_object_height,
      Field("min_object_height", "a contact higher than the desk plus this is on an object").in(Unit::metre).above(0));
  fields.choice(touch, Field("touch", "from where the tool comes").neutral("top"),
                {{"top", "from above, straight down", {}}, {"any", "from any side, along lines of any direction", {}}});
  fields.choice(placement, Field("placement", "where the objects stand"),
                {{"fixed", "at `at`, turned by `rotation`", {}},
                 {"random",
                  "position and rotation of each object from the seed, wholly inside the area, none over another",
                  {}}});
  fields.sections(
      objects, Field("objects",
                     "what stands on the desk; or {draw: {least: 2, most: 6, of: [...]}}: as many from the seed, each "
                     "one of a list, in which a number may be uniform(3 cm, 8 cm)")
                   .drawable());
  fields.section(effects, Field("effects", "how taps differ from perfect ones; each is absent by default").group());
}

}  // namespace palpate
