// SPDX-License-Identifier: MIT
// From the options of an object to its shape, built in or a plugin.
#pragma once

#include "scene/scene_options.hpp"

#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <memory>

namespace palpate {

/// Never null. `context` must outlive a shape that is a plugin; throws what making that throws.
std::shared_ptr<const Shape> make_shape(const ObjectOptions& object, const Context& context);

}  // namespace palpate
