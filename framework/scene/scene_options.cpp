// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Largest tilt, radians. Up to this tilt, a vertical line still clearly points down in the object's own frame, despite
/// rounding errors.
constexpr double kSteepestTilt = 80.0 / 180.0 * 3.14159265358979323846 * (1 + 1e-12);

}  // namespace

void AreaOptions::list(Fields& fields) {
  fields.real(width, Field("width", "size of the area along the x axis")
                         .in(Unit::metre)
                         .above(0)
                         .from("Sun and Min 2021: 23 cm")
                         .needed());
  fields.real(depth, Field("depth", "size of the area along the y axis")
                         .in(Unit::metre)
                         .above(0)
                         .from("Sun and Min 2021: 23 cm")
                         .needed());
}

void ObjectOptions::list(Fields& fields) {
  fields.adopt(shape, Field("type", "shape of the object").needed());
  fields.reals(at, 2,
               Field("at",
                     "x, y of the object's centre. The centre is the middle of the rectangle around the outline of the "
                     "upright object, seen from above")
                   .in(Unit::metre));
  fields.real(rotation, Field("rotation",
                              "counter-clockwise rotation about the vertical axis through `at`. At 0 the object's own "
                              "x axis is parallel to the x axis of the area")
                            .in(Unit::radian));
  fields.real(tilt,
              Field("tilt",
                    "tilt about the object's own y axis, applied before the rotation, from -80 to 80 deg. A positive "
                    "tilt raises the object's +x end. The lowest point of the tilted object rests on the desk")
                  .in(Unit::radian));
  fields.require(std::abs(tilt) <= kSteepestTilt, "tilt", "is more than 80 deg");
}

void SceneOptions::list(Fields& fields) {
  fields.section(area, Field("area", "rectangle of the desk in which taps are allowed").needed());
  fields.real(desk, Field("desk", "height of the desk").in(Unit::metre));
  fields.real(
      min_object_height,
      Field("min_object_height",
            "minimum height above the desk of a contact with an object. Lower contacts count as contacts with the desk")
          .in(Unit::metre)
          .above(0));
  fields.choice(placement, Field("placement", "placement of the objects"),
                {{"fixed", "each object has the configured position `at` and rotation `rotation`", {}},
                 {"random",
                  "position and rotation of each object are drawn from the seed. All objects are wholly inside the "
                  "area and do not overlap",
                  {}}});
  fields.sections(
      objects, Field("objects",
                     "list of objects on the desk. With {draw: {least: 2, most: 6, of: [...]}}, 2 to 6 objects are "
                     "drawn from the list `of`. A number in this list may be a range, for example uniform(3 cm, 8 cm)")
                   .drawable());
  fields.section(
      effects, Field("effects", "simulated errors of sensor, arm and scene; each effect is absent by default").group());
}

}  // namespace palpate
