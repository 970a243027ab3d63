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
/// `kernel.length_scale=`. The completions contain the options of the plugin that the config and the overrides choose.
/// If the config is invalid, they contain the options of the default plugin.
std::vector<Completion> complete_key(CommandEnvironment& program, const std::string& config,
                                     const std::vector<std::string>& before, const std::string& typed);

/// Returns the first sentence of the comment at the beginning of a config; "" if there is no comment.
std::string purpose_of(const std::filesystem::path& config);

/// Returns the names of the plugins of a kind. The meaning of each is the purpose of the shipped group file with the
/// same name.
std::vector<Completion> plugin_names(const CommandEnvironment& program, const std::string& kind);

}  // namespace palpate::cli
