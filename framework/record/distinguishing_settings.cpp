// SPDX-License-Identifier: MIT
#include "record/distinguishing_settings.hpp"

#include "record/catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <tuple>

namespace palpate {
namespace {

constexpr std::size_t kMostShown = 3;
/// Largest number of settings that are compared. Each setting is compared over all pairs of runs, and configs may
/// differ in 100,000 values.
constexpr std::size_t kMostCompared = 64;

/// One setting and its values in all runs.
struct SettingValues {
  std::string name;                ///< "scene", "kernel.length_scale"
  std::string block;               ///< first part of the name
  std::vector<std::string> words;  ///< value in each run; "" where the run has none
  std::vector<std::size_t> codes;  ///< code per run; runs with equal values have equal codes
  std::vector<std::size_t> equal;  ///< number of runs with this value, by code
  int rank = 0;                    ///< on a tie the setting with the smallest rank comes first

  std::size_t distinguished(std::size_t run) const { return codes.size() - equal[codes[run]]; }
};

std::string block_of(const std::string& key) { return key.substr(0, key.find('.')); }

SettingValues setting(const std::string& name, std::vector<std::string> words, int rank) {
  SettingValues out{name, block_of(name), std::move(words), {}, {}, rank};
  std::map<std::string, std::size_t> known;
  for (const std::string& word : out.words) {
    const std::size_t code = known.emplace(word, known.size()).first->second;
    out.codes.push_back(code);
    out.equal.resize(known.size());
    ++out.equal[code];
  }
  return out;
}

/// Returns one text per run, which lists those groups of this kind that the run has and at least one other run lacks.
/// If there are none, the text lists all groups of this kind that the run has. Returns an empty list if a run has no
/// group of this kind.
std::vector<std::string> group_words(const std::vector<RecordedSettings>& runs, const std::string& kind) {
  std::map<std::string, std::size_t> counts;
  for (const RecordedSettings& run : runs) {
    const auto found = run.groups.find(kind);
    if (found == run.groups.end()) return {};
    for (const std::string& group : found->second) ++counts[group];
  }
  std::vector<std::string> out;
  for (const RecordedSettings& run : runs) {
    const std::set<std::string>& own = run.groups.at(kind);
    std::vector<std::string> special;
    std::copy_if(own.begin(), own.end(), std::back_inserter(special),
                 [&](const std::string& group) { return counts[group] < runs.size(); });
    if (special.empty()) special.assign(own.begin(), own.end());
    out.push_back(fmt::format("{}", fmt::join(special, ", ")));
  }
  return out;
}

std::vector<SettingValues> differing_settings(const std::vector<RecordedSettings>& runs) {
  std::vector<Row> configs;
  configs.reserve(runs.size());
  for (const RecordedSettings& run : runs) configs.push_back(run.values);
  std::vector<std::string> keys = differing_keys(configs);
  keys.resize(std::min(keys.size(), kMostCompared));
  // A key that the first runs lack is placed next to the other keys of its block.
  std::map<std::string, std::size_t> order;
  for (const Row& config : configs) {
    for (const auto& field : config.fields) order.emplace(block_of(field.first), order.size());
  }
  std::stable_sort(keys.begin(), keys.end(), [&](const std::string& a, const std::string& b) {
    return order.at(block_of(a)) < order.at(block_of(b));
  });
  std::vector<SettingValues> out;
  std::set<std::string> blocks;
  for (const std::string& key : keys) {
    std::vector<std::string> values;
    for (const Row& config : configs) values.push_back(config.text(key));
    SettingValues one = setting(key, std::move(values), key == "seed" ? 0 : boost::ends_with(key, ".type") ? 2 : 3);
    if (blocks.insert(one.block).second) {
      const std::vector<std::string> groups = group_words(runs, one.block);
      const bool differ = std::adjacent_find(groups.begin(), groups.end(), std::not_equal_to<>()) != groups.end();
      if (differ) out.push_back(setting(one.block, groups, 1));
    }
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<std::string> distinguishing(const std::vector<SettingValues>& settings, std::size_t run) {
  std::vector<std::string> out;
  std::set<std::string> blocks;
  std::vector<std::size_t> rest;  // runs that the chosen settings do not distinguish yet
  for (std::size_t other = 0; !settings.empty() && other < settings.front().codes.size(); ++other) {
    if (other != run) rest.push_back(other);
  }
  while (out.size() < kMostShown) {
    const SettingValues* best = nullptr;
    std::tuple<std::size_t, std::size_t, int> most;
    for (const SettingValues& one : settings) {
      const bool is_new = blocks.count(one.block) == 0;
      const auto apart = static_cast<std::size_t>(std::count_if(
          rest.begin(), rest.end(), [&](std::size_t other) { return one.codes[other] != one.codes[run]; }));
      if (one.words[run].empty() || (apart == 0 && !is_new)) continue;
      const std::tuple score(apart, one.distinguished(run), -one.rank);
      if (best == nullptr || score > most) std::tie(best, most) = std::tuple(&one, score);
    }
    if (best == nullptr || best->distinguished(run) == 0) return out;
    out.push_back(fmt::format("{} {}", best->name, best->words[run]));
    blocks.insert(best->block);
    rest.erase(std::remove_if(rest.begin(), rest.end(),
                              [&](std::size_t other) { return best->codes[other] != best->codes[run]; }),
               rest.end());
  }
  return out;
}

}  // namespace

std::map<std::string, std::set<std::string>> recorded_groups(const std::map<std::string, std::string>& origins) {
  std::map<std::string, std::set<std::string>> out;
  for (const auto& [path, origin] : origins) {
    const std::size_t end = origin.find(".yaml:");
    if (end == std::string::npos) continue;
    const std::filesystem::path file = origin.substr(0, end);
    const std::string kind = file.parent_path().filename().string();
    if (kind == path.substr(0, path.find('.'))) out[kind].insert(file.filename().string());
  }
  return out;
}

std::vector<std::vector<std::string>> distinguishing_settings(const std::vector<RecordedSettings>& runs) {
  const std::vector<SettingValues> settings = differing_settings(runs);
  std::vector<std::vector<std::string>> out;
  for (std::size_t run = 0; run < runs.size(); ++run) out.push_back(distinguishing(settings, run));
  return out;
}

}  // namespace palpate
