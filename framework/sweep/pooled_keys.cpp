// SPDX-License-Identifier: MIT
#include "experiment/experiment_options.hpp"
#include "record/catalogue.hpp"
#include "sweep/pooled_settings.hpp"
#include "sweep/sweep.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace palpate {
namespace {

using PoolTexts = std::vector<std::string>;

/// Returns whether one of `keys` decides the option at `path`. A key decides the path if it lies above the path, if the
/// path inherits from it, or if it is a strategy. A key with the same parent as the path also decides it if some config
/// lacks the option.
bool is_decided(const std::string& path, const PoolTexts& keys, const std::vector<Row>& configs) {
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    if (is_at_or_below(path, key) || is_one_of(config_keys().heirs_of(key), path)) return true;
    if (key == kStrategy) return config_keys().is_of_strategy(path);
    const auto dot = path.rfind('.');
    const bool beside = dot != std::string::npos && key.rfind('.') == dot && key.compare(0, dot, path, 0, dot) == 0;
    const auto lacks = [&](const Row& one) { return one.find(path) == nullptr; };
    return beside && std::any_of(configs.begin(), configs.end(), lacks);
  });
}

/// Returns the topmost group above `path` whose type is one of the `differing` options. Without such a group, returns
/// the group around the list that contains `path`, or `path` itself if it is not in a list.
std::string enclosing_choice(const std::string& path, const PoolTexts& differing) {
  std::string group;
  for (auto dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
    std::string part = path.substr(0, dot);
    if (config_keys().is_group(part) || config_keys().is_typed(part)) group = part;
    if (group == part && is_one_of(differing, part + ".type")) return part;
    if (std::isdigit(static_cast<unsigned char>(path[dot + 1])) != 0) return group.empty() ? part : group;
  }
  return path;
}

}  // namespace

bool decides_run(const std::string& path) {
  static const std::set<std::string> kNeutral{"name", "log", "expect", "complete", "sweep"};
  return kNeutral.count(first_key(path)) == 0 && last_key(path) != "folder" && path != kThreads;
}

std::vector<std::string> further_differences(const std::vector<PooledSetting>& settings,
                                             const std::vector<std::string>& keys) {
  std::vector<Row> configs;
  for (const PooledSetting& one : settings) configs.push_back(settings_of(one.config));
  const PoolTexts paths = differing_keys(configs);
  PoolTexts out;
  for (const std::string& path : paths) {
    if (path == "seed" || !decides_run(path) || is_decided(path, keys, configs)) continue;
    std::string whole = enclosing_choice(path, paths);
    if (!is_decided(whole, out, configs) && !is_decided(path, out, configs)) out.push_back(std::move(whole));
  }
  const PoolTexts all = out;
  const auto is_below = [&](const std::string& path) {
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& other) { return path != other && is_at_or_below(path, other); });
  };
  out.erase(std::remove_if(out.begin(), out.end(), is_below), out.end());
  return out;
}

}  // namespace palpate
