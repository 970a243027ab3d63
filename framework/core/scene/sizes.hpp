// SPDX-License-Identifier: MIT
// Sizes of objects that a config says in part.
#pragma once

#include "config/resolve.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns a line for each object of which the config says some lengths and leaves others at their defaults:
/// "e.yaml:4:7: scene.objects.0: not said and so at its default: height 5 cm". `resolved` is the tree that resolve()
/// returned with `notes`.
std::vector<std::string> half_said_sizes(const Tree& resolved, const ResolveNotes& notes);

}  // namespace palpate
