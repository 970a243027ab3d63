// SPDX-License-Identifier: MIT
// Completion of KEY=VALUE, based on the fields that configs can have.
#pragma once

#include "cli/completion.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::cli {

/// Returns the completions of `typed`, the beginning of an override. `config` is the file of the config, and `before`
/// are the earlier overrides. Keys are completed level by level, like folders: first `kernel.`, then
/// `kernel.length_scale=`. The options of a plugin are those of the plugin that the config and the overrides choose. If
/// the config cannot be read, they are those of the default plugin.
std::vector<Completion> complete_key(Program& program, const std::string& config,
                                     const std::vector<std::string>& before, const std::string& typed);

/// Returns the first sentence of the comment at the beginning of a config. Returns "" if there is none.
std::string purpose_of(const std::filesystem::path& config);

/// Returns the names of the plugins of a kind. Each has the purpose of the shipped config with the same name.
std::vector<Completion> plugin_names(const Program& program, const std::string& kind);

}  // namespace palpate::cli
