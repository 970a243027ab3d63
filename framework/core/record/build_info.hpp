// SPDX-License-Identifier: MIT
// What program this is, for manifests: enough to tell whether two runs were made by the same code.
#pragma once

#include "config/tree.hpp"
#include "plugin/host.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <utility>

namespace palpate {

/// Folders that belong to the program, in a build tree or installed.
struct Installation {
  std::filesystem::path program;
  std::filesystem::path plugins;
  std::filesystem::path configs;
};

/// Where this very program lies.
Installation find_installation();

/// Of this machine, "" if it has none.
std::string host_name();

extern const char* const kVersion;

/// The plugins of one run, by kind and name.
using PluginNames = std::set<std::pair<std::string, std::string>>;

/// One hash over the program (its build id) and the plugins of a run. Equal for equal code: neither a commit alone nor
/// another plugin changes it.
std::string build_hash(const PluginHost& host, const PluginNames& plugins);

/// Version, commit (of the last build; dirty or not), compiler, instruction path, library versions, plugins, host.
Tree describe_build(const Installation& installation, const PluginHost& host, const PluginNames& plugins,
                    const std::string& instruction_path);

}  // namespace palpate
