// SPDX-License-Identifier: MIT
// The plugins that the program itself contains.
#pragma once

#include <palpate/plugin.hpp>

#include <vector>

namespace palpate {

/// Returns their manifests. Defined in belief/builtin_plugins.cpp; the belief `height_map` is the only one.
const std::vector<PluginManifest>& builtin_plugins();

}  // namespace palpate
