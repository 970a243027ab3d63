// SPDX-License-Identifier: MIT
// The plugins that the program itself contains.
#pragma once

#include <palpate/plugin.hpp>

#include <vector>

namespace palpate {

/// Returns the manifests of the plugins that the program itself contains. At present, the only such plugin is the
/// belief `height_map`. The function is defined in belief/builtin_plugins.cpp.
const std::vector<PluginManifest>& builtin_plugins();

}  // namespace palpate
