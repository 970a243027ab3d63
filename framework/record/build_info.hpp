// SPDX-License-Identifier: MIT
// Description of this program for manifests, which shows whether two runs were made by the same code.
#pragma once

#include "config/tree.hpp"
#include "host/plugin_host.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// Paths of one installation, or of one build tree.
struct Installation {
  std::filesystem::path program;  ///< the program that users start
  std::filesystem::path whole;    ///< the program with all commands; in an installation, the same as `program`
  std::filesystem::path plugins;
  std::filesystem::path configs;
};

/// Returns the installation of the running program. Throws Error as the overload below does.
Installation find_installation();

/// Returns the installation of `file`, a program or a library such as the Python module: the nearest folder above it
/// that contains lib/palpate. The folder is a prefix (bin/palpate, lib/palpate/<kind>/<name>.so, share/palpate/configs)
/// or build/<preset> of a source tree. `file` must not contain links. Throws Error if there is no such folder.
Installation find_installation(const std::filesystem::path& file);

/// Returns the name of this machine; "" if it has none.
std::string host_name();

extern const char* const kVersion;

/// Hash of the compiled core library and of the libraries linked into it. cmake/CoreHash.cmake computes this hash for
/// each program that links the core library.
extern const char* const kCoreHash;

/// Returns the output of `palpate --version` without the last newline: version, commit, build and compiler, one per
/// line.
std::string build_text(const Installation& installation);

/// Returns one hash of the core library and the plugins of a run; equal code gives equal hashes. The hash does not
/// depend on other plugins, commands, pages, or commits without changes of code.
std::string build_hash(const PluginHost& host, const PluginNames& plugins);

/// Returns the manifest's description of this program: version, commit of the last build, whether it had uncommitted
/// changes, build hashes, compiler, instruction path (the CPU instruction set in use), library versions, plugins and
/// host.
Tree describe_build(const Installation& installation, const PluginHost& host, const PluginNames& plugins,
                    const std::string& instruction_path);

}  // namespace palpate
