// SPDX-License-Identifier: MIT
// The plugin host finds, checks and loads libraries, and creates the objects of plugins. No other code loads libraries;
// it only uses the interfaces in include/palpate.
#pragma once

#include "config/resolve.hpp"

#include <palpate/plugin.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A library in the list of `palpate plugins`.
struct PluginListing {
  std::string kind;
  std::string name;
  std::filesystem::path file;
  std::string summary;  ///< "" if the library cannot be used
  std::string trouble;  ///< one line: file, failed step of loading, reason; "" for a usable library
};

/// A plugin library that a run uses, as described in the run's manifest.
struct LoadedPlugin {
  std::string kind;
  std::string name;
  std::filesystem::path file;
  std::string hash;  ///< hash of the loaded parts of the file: see loaded_hash.hpp
};

/// Returns kind and name of all plugins of a build tree, including plugins that are not built yet. `folder` is its
/// plugin folder, which contains a list of them. Returns nothing for any other folder, such as an installed one.
PluginNames plugins_of_build(const std::filesystem::path& folder);

/// Loads libraries and keeps them loaded for its lifetime. An object that a library created keeps the library loaded
/// even after the end of the host. The class is thread-safe.
class PluginHost final : public PluginSource, public PluginFactory {
 public:
  /// Searches for <folder>/<kind>/<name>.so in each of `folders`.
  explicit PluginHost(const std::vector<std::filesystem::path>& folders);
  ~PluginHost() override;

  /// Sets a function that returns group names, which users may write instead of a plugin's name. Errors about unknown
  /// names use it for their hints. Call this before other threads use the host.
  void set_group_names(std::function<std::vector<std::string>(const std::string& kind)> names) {
    group_names_ = std::move(names);
  }

  /// Returns the folders of PALPATE_PLUGIN_PATH (separated by ':'), followed by `shipped`.
  static std::vector<std::filesystem::path> search_path(const std::filesystem::path& shipped);

  /// Loads <kind>/<name>.so if necessary, and no other file. Throws Error, without a source location, if the library is
  /// missing (the hint is the most similar name) or if two folders have it. If the library cannot be loaded or fails a
  /// check, the Error names the file, the step (such as `comparing the ABI`) and the reason.
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override;

  /// Throws Error for any exception of the plugin's constructor. The source location of the Error is where the config
  /// chooses the plugin, unless the plugin gives another location.
  std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override;

  /// Throws Error as create() does.
  std::shared_ptr<const Motions> motions(const PluginChoice& choice, const Scene& scene) const override;

  /// Returns all libraries of `kind` and `name`, sorted, including broken libraries; each name occurs once. `kind` and
  /// `name` may be "" for all.
  std::vector<PluginListing> list(const std::string& kind, const std::string& name) const;

  /// Returns the sorted names of a kind, including plugins that are not built yet. Opens no library.
  std::vector<std::string> names(const std::string& kind) const;

  /// Returns file and hash of each plugin's library, in the order of `plugins`. Loads the libraries if necessary.
  /// Plugins that the program itself contains are left out. Throws Error.
  std::vector<LoadedPlugin> loaded(const PluginNames& plugins) const;

  /// Returns whether one of these plugins moves a device that only one run can use at a time, such as an arm. Loads the
  /// plugins if necessary. Throws Error.
  bool one_at_a_time(const PluginNames& plugins) const;

  /// Returns whether a folder has a library with this name; the library may be broken.
  bool has(const std::string& kind, const std::string& name) const;

  /// Returns all plugin kinds.
  static std::vector<std::string> kinds();

 private:
  class Library;
  /// Loads a library, lists its options, and closes it again. Returns its summary. Call this only in a child process
  /// that ends afterwards.
  std::string look(const std::string& kind, const std::string& name) const;
  std::shared_ptr<const Library> library(const std::string& kind, const std::string& name) const;
  std::vector<std::pair<std::string, std::filesystem::path>> files(const std::string& kind) const;

  std::vector<std::filesystem::path> folders_;
  std::function<std::vector<std::string>(const std::string& kind)> group_names_;  ///< may be empty
  mutable std::mutex mutex_;
  mutable std::map<std::pair<std::string, std::string>, std::shared_ptr<const Library>> libraries_;
};

}  // namespace palpate
