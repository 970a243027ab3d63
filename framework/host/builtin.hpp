// SPDX-License-Identifier: MIT
// The plugins that the program itself contains.
#pragma once

#include <palpate/plugin.hpp>

#include <vector>

namespace palpate {

/// Returns their manifests. Defined in experiment/, whose belief is one of them.
const std::vector<PluginManifest>& builtin_plugins();

}  // namespace palpate
