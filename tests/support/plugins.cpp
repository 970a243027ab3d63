// SPDX-License-Identifier: MIT
#include "support/plugins.hpp"

#include "config/describe.hpp"
#include "config/resolve.hpp"
#include "config/yaml.hpp"
#include "scene/scene_options.hpp"
#include "support/filled.hpp"
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

/// The smallest options that hold a plugin.
struct Holder : Options {
  PluginChoice choice;
  void list(Fields& fields) override { fields.plugin(choice, Field("plugin", "under test")); }
};

bool needs_options(const std::string& kind, const std::string& name) {
  const std::vector<FieldDescription> fields =
      describe_fields([&](Fields& list) { contract_host().describe(kind, name, list); });
  return std::any_of(fields.begin(), fields.end(), [](const FieldDescription& field) { return field.required; });
}

}  // namespace

PluginChoice choose(const PluginHost& host, const std::string& kind, const std::string& name,
                    const std::string& options) {
  Tree chosen = parse_yaml(options, "options.yaml");
  chosen.at("type") = Tree::scalar(name);
  Tree input = Tree::map();
  input.at("plugin") = std::move(chosen);
  Holder holder;
  holder.choice.kind = kind;
  ResolveNotes notes;
  resolve(holder, input, host, notes);
  return holder.choice;
}

const Scene& wave_scene() {
  static const std::unique_ptr<const Scene> scene = [] {
    const std::string yaml = "{area: {width: 23 cm, depth: 23 cm}, objects: [{type: wave}]}";
    return build_scene(filled<SceneOptions>(yaml), 1, contract_host());
  }();
  return *scene;
}

Context context_of(const PluginHost& host, std::uint64_t seed) { return {host, wave_scene(), seed, nullptr}; }

const PluginHost& contract_host() {
  static const PluginHost host(PluginHost::search_path(plugin_folder()));
  return host;
}

std::vector<std::string> plugins_under_contract(const std::string& kind) {
  // A process for each, and many suites ask for the same kind.
  static std::map<std::string, std::vector<std::string>> known;
  const auto [entry, is_new] = known.try_emplace(kind);
  std::vector<std::string>& names = entry->second;
  if (!is_new) return names;
  std::set<std::string> files;
  std::error_code none;
  for (const fs::path& folder : PluginHost::search_path(plugin_folder())) {
    for (const auto& file : fs::directory_iterator(folder / kind, none)) files.insert(file.path().stem().string());
  }
  // Of a program that runs one case of one plugin, most of the time would go into looking at the others.
  const std::string cases = GTEST_FLAG_GET(filter);
  const bool one = cases.find('*') == std::string::npos && cases.find('/') != std::string::npos;
  for (const std::string& name : files) {
    if (one && cases.find(test_name(name)) == std::string::npos) continue;
    const std::vector<PluginListing> rows = contract_host().list(kind, name);
    if (rows.empty() || (rows.front().trouble.empty() && needs_options(kind, name))) continue;
    names.push_back(name);
  }
  return names;
}

std::string test_name(std::string plugin) {
  std::replace(plugin.begin(), plugin.end(), '-', '_');
  return plugin;
}

}  // namespace palpate::test
