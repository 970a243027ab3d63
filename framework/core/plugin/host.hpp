// SPDX-License-Identifier: MIT
// Finds, checks, loads and creates plugins. The only door to dynamic loading: everything behind it is one of the
// interfaces of include/palpate.
#pragma once

#include "config/resolve.hpp"

#include <palpate/plugin.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A library that was found, for `palpate plugins`.
struct PluginListing {
  std::string kind;
  std::string name;
  std::filesystem::path file;
  std::string summary;  ///< empty if the library cannot be used
  std::string trouble;  ///< one line: file, step, reason; empty if all is well
};

/// A library that a run uses, for its manifest.
struct LoadedPlugin {
  std::string kind;
  std::string name;
  std::filesystem::path file;
  std::string hash;  ///< of what is loaded of the file: loaded_hash.hpp
};

/// Kind and name of the plugins of a build, whether they are built or not: what its plugin folder lists. Empty for any
/// other folder, an installed one too.
PluginNames plugins_of_build(const std::filesystem::path& folder);

/// Keeps every library that it loaded until it dies; so does every object that it made. Safe to use from several
/// threads.
class PluginHost final : public PluginSource, public PluginFactory {
 public:
  /// Looks for <folder>/<kind>/<name>.so in each of `folders`.
  explicit PluginHost(const std::vector<std::filesystem::path>& folders);
  ~PluginHost() override;

  /// What users may also write in the place of a plugin of a kind, the names of groups: known to errors about a name
  /// that is none. To be set before the host is used by several threads.
  void set_group_names(std::function<std::vector<std::string>(const std::string& kind)> names) {
    group_names_ = std::move(names);
  }

  /// The folders of PALPATE_PLUGIN_PATH (separated by ':'), then `shipped`.
  static std::vector<std::filesystem::path> search_path(const std::filesystem::path& shipped);

  /// Loads <kind>/<name>.so if need be, and no other file. Throws Error, without place, if it is missing (with the
  /// nearest name), if two folders have it, or if a check fails: then the message names file, step and reason.
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override;

  /// Throws Error when the plugin's constructor throws whatever it may, with the place of the choice in the config
  /// unless the plugin names a place of its own.
  std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override;

  /// Throws as create() does.
  std::shared_ptr<const Motions> motions(const PluginChoice& choice, const Scene& scene) const override;

  /// Every library found, sorted, each name once; broken ones too. `kind` and `name` may be empty for all.
  std::vector<PluginListing> list(const std::string& kind, const std::string& name) const;

  /// Every name of a kind, sorted, those that are not built yet too; no library is opened.
  std::vector<std::string> names(const std::string& kind) const;

  /// File and hash of the given plugins (kind, name), in their order; loads them if need be. Throws Error.
  std::vector<LoadedPlugin> loaded(const PluginNames& plugins) const;

  /// Whether one of the given plugins moves something that exists only once; loads them if need be. Throws Error.
  bool one_at_a_time(const PluginNames& plugins) const;

  /// Whether a folder has a library of that name, whatever is in it.
  bool has(const std::string& kind, const std::string& name) const;

  /// The kinds that exist.
  static std::vector<std::string> kinds();

 private:
  class Library;
  /// Loads a library, has it list its options, and lets go of all: for a process that ends then. What is said of it.
  std::string look(const std::string& kind, const std::string& name) const;
  std::shared_ptr<const Library> library(const std::string& kind, const std::string& name) const;
  std::vector<std::pair<std::string, std::filesystem::path>> files(const std::string& kind) const;

  std::vector<std::filesystem::path> folders_;
  std::function<std::vector<std::string>(const std::string& kind)> group_names_;  ///< may be empty
  mutable std::mutex mutex_;
  mutable std::map<std::pair<std::string, std::string>, std::shared_ptr<const Library>> libraries_;
};

}  // namespace palpate
