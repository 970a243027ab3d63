// SPDX-License-Identifier: MIT
// A block whose top is a wave along its length: closed form when upright, critical points and bisection when tilted.
#pragma once

#include "scene/scene_options.hpp"

#include <palpate/shape.hpp>

#include <memory>

namespace palpate {

std::unique_ptr<const Shape> make_wave(const WaveOptions& options);

}  // namespace palpate
