// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Lines into a tilted object must point down in its own frame, by more than rounding.
constexpr double kSteepestTilt = 80.0 / 180.0 * 3.14159265358979323846 * (1 + 1e-12);

}  // namespace

void AreaOptions::list(Fields& fields) {
  fields.real(
      width,
      Field("width", "extent of the area along x").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
  fields.real(
      depth,
      Field("depth", "extent of the area along y").in(Unit::metre).above(0).from("Sun and Min 2021: 23 cm").needed());
}

void ObjectOptions::list(Fields& fields) {
  fields.adopt(shape, Field("type", "shape of the object").needed());
  fields.reals(
      at, 2,
      Field("at", "x, y of the centre of the rectangle around the outline of the upright object").in(Unit::metre));
  fields.real(
      rotation,
      Field("rotation", "rotation about the vertical through `at`, counter-clockwise; at 0 the length lies along x")
          .in(Unit::radian));
  fields.real(tilt, Field("tilt",
                          "angle by which the +x end of the length is lifted before the rotation, within 80 deg either "
                          "way; the lowest point then rests on the desk")
                        .in(Unit::radian));
  fields.require(std::abs(tilt) <= kSteepestTilt, "tilt", "is more than 80 deg");
}

void SceneOptions::list(Fields& fields) {
  fields.section(area, Field("area", "rectangle of the desk in which taps are allowed").needed());
  fields.real(desk, Field("desk", "height of the desk").in(Unit::metre));
  fields.real(min_object_height,
              Field("min_object_height", "height above the desk beyond which a contact counts as on an object")
                  .in(Unit::metre)
                  .above(0));
  fields.choice(touch, Field("touch", "directions from which the tool taps").neutral("top"),
                {{"top", "from above, straight down", {}}, {"any", "from any side, along lines of any direction", {}}});
  fields.choice(placement, Field("placement", "placement of the objects"),
                {{"fixed", "position `at` and rotation `rotation` of each object", {}},
                 {"random",
                  "position and rotation of each object drawn from the seed, wholly inside the area, without overlap",
                  {}}});
  fields.sections(objects, Field("objects",
                                 "list of objects on the desk, or {draw: {least: 2, most: 6, of: [...]}} to draw 2 to "
                                 "6 objects from a list, in which a number may be uniform(3 cm, 8 cm)")
                               .drawable());
  fields.section(effects,
                 Field("effects", "simulated deviations from perfect taps; each effect is absent by default").group());
}

}  // namespace palpate
