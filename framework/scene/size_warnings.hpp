// SPDX-License-Identifier: MIT
// Warns about objects for which a config sets only some of the lengths.
#pragma once

#include "config/resolve.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns one line per object for which the config sets some lengths and leaves others at their defaults. Example:
/// "e.yaml:4:7: scene.objects.0: not given, so the default is used: height 5 cm". `resolved` and `notes` are the
/// results of resolve().
std::vector<std::string> partly_given_sizes(const Tree& resolved, const ResolveNotes& notes);

}  // namespace palpate
