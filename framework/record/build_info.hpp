// SPDX-License-Identifier: MIT
// What program this is, for manifests: enough to tell whether two runs were made by the same code.
#pragma once

#include "config/tree.hpp"
#include "host/host.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// What belongs together, in a build tree or installed.
struct Installation {
  std::filesystem::path program;  ///< what users call
  std::filesystem::path whole;    ///< the program that has every command; installed, it is the one that users call
  std::filesystem::path plugins;
  std::filesystem::path configs;
};

/// That of this very program; throws Error as below.
Installation find_installation();

/// That of a program, or of a library as Python's module is one: the nearest folder above `file` that has lib/palpate,
/// which is a prefix (bin/palpate, lib/palpate/<kind>/<name>.so, share/palpate/configs) or build/<preset> of a source
/// tree. `file` has no links in it. Throws Error if there is none.
Installation find_installation(const std::filesystem::path& file);

/// Of this machine, "" if it has none.
std::string host_name();

extern const char* const kVersion;

/// A hash over all of core as it was compiled, and over what is linked into it: cmake/CoreHash.cmake makes it, for
/// every program that core is linked to.
extern const char* const kCoreHash;

/// What `palpate --version` prints, without the last newline: version, commit, build and compiler, a line each.
std::string build_text(const Installation& installation);

/// One hash over core and the plugins of a run. Equal for equal code: neither a commit alone, nor another plugin, nor a
/// command or a page that says something else changes it.
std::string build_hash(const PluginHost& host, const PluginNames& plugins);

/// Version, commit (of the last build; dirty or not), compiler, instruction path, library versions, plugins, host.
Tree describe_build(const Installation& installation, const PluginHost& host, const PluginNames& plugins,
                    const std::string& instruction_path);

}  // namespace palpate
