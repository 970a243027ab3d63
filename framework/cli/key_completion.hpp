// SPDX-License-Identifier: MIT
// Completion of KEY=VALUE from the field lists of the config.
#pragma once

#include "cli/completion.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::cli {

/// Returns the completions of `typed`, the beginning of an override of the config in the file `config`, after the
/// overrides `before`. Keys come level by level, as folders do: first `kernel.`, then `kernel.length_scale=`. The
/// options of a plugin are those of the plugin that the config and the overrides choose, or of the default plugin if
/// they cannot be read.
std::vector<Completion> complete_key(Program& program, const std::string& config,
                                     const std::vector<std::string>& before, const std::string& typed);

/// Returns the first sentence of the comment at the beginning of a config; "" if there is none.
std::string purpose_of(const std::filesystem::path& config);

/// Returns the names of the plugins of a kind, with the purposes of the shipped configs of the same names.
std::vector<Completion> plugin_names(const Program& program, const std::string& kind);

}  // namespace palpate::cli
