// SPDX-License-Identifier: MIT
#include "scene/shapes.hpp"

#include "scene/convex.hpp"
#include "scene/prism.hpp"
#include "scene/wave.hpp"

namespace palpate {

std::shared_ptr<const Shape> make_shape(const ObjectOptions& object, const Context& context) {
  using Type = ObjectOptions::Type;
  switch (object.type) {
    case Type::wave:
      return make_wave(object.wave);
    case Type::slope:
      return make_slope(object.slope);
    case Type::block:
      return make_block(object.block);
    case Type::dome:
      return make_dome(object.dome);
    case Type::cylinder:
      return make_cylinder(object.cylinder);
    case Type::cone:
      return make_cone(object.cone);
    case Type::ellipsoid:
      return make_ellipsoid(object.ellipsoid);
    case Type::l:
      return make_l(object.bars);
    case Type::t:
      return make_t(object.bars);
    case Type::ring:
      return make_ring(object.ring);
    case Type::polygon:
      return make_polygon(object.polygon);
    case Type::mesh:
      return context.create<const Shape>(object.mesh);
    case Type::plugin:
      return context.create<const Shape>(object.plugin);
  }
  return nullptr;
}

}  // namespace palpate
