// SPDX-License-Identifier: MIT
// Makes the warning about objects whose sizes a config sets only in part.
#pragma once

#include "config/resolve.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns one line per object with some lengths from the config and others at their defaults. Example: "e.yaml:4:7:
/// scene.objects.0: not given, so the default is used: height 5 cm". `resolved` and `notes` are the results of
/// resolve().
std::vector<std::string> partly_given_sizes(const Tree& resolved, const ResolveNotes& notes);

}  // namespace palpate
