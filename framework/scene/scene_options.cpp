// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"

namespace palpate {

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

void ObjectOptions::list(Fields& fields) {
  fields.choice(type, Field("type", "shape of the object").needed(),
                {{"wave", "block with a wavy top", [this](Fields& inner) { wave.list(inner); }},
                 {"slope", "block with a sloping top", [this](Fields& inner) { slope.list(inner); }}});
  fields.reals(at, 2, Field("at", "place of the centre: x, y").in(Unit::metre));
  fields.real(rotation, Field("rotation", "counter-clockwise, 0 lays the length along x").in(Unit::radian));
}

void SceneOptions::list(Fields& fields) {
  fields.section(area, Field("area", "the rectangle of the desk in which taps may fall").needed());
  fields.real(desk, Field("desk", "height of the desk").in(Unit::metre));
  fields.real(
      on_surface_above,
      Field("on_surface_above", "a contact higher than the desk plus this is on an object").in(Unit::metre).above(0));
  fields.choice(placement, Field("placement", "where the objects stand"),
                {{"fixed", "at `at`, turned by `rotation`", {}},
                 {"random", "position and rotation of each object from the seed, wholly inside the area", {}}});
  fields.sections(objects, Field("objects", "what stands on the desk"));
  fields.section(effects, Field("effects", "how taps differ from perfect ones; each is absent by default"));
}

}  // namespace palpate
