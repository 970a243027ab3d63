// SPDX-License-Identifier: MIT
// What may be typed next of KEY=VALUE, from the field lists that read configs.
#pragma once

#include "cli/completion.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::cli {

/// For `typed`, the beginning of an override of the config in the file `config`, behind the overrides `before`. Keys
/// come level by level, as folders do: `kernel.`, then `kernel.length_scale=`. Which options a plugin's group has
/// depends on the plugin that config and overrides choose; where they cannot be read, on defaults.
std::vector<Completion> complete_key(Program& program, const std::string& config,
                                     const std::vector<std::string>& before, const std::string& typed);

/// The first sentence of a config, where it begins with a comment that says what it is for; "" if it does not.
std::string purpose_of(const std::filesystem::path& config);

/// The names of a kind's plugins, with what the shipped config of that name says.
std::vector<Completion> plugin_names(const Program& program, const std::string& kind);

}  // namespace palpate::cli
