// SPDX-License-Identifier: MIT
#include "config/keys.hpp"
#include "record/run.hpp"
#include "sweep/description.hpp"
#include "sweep/pooled_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Classes of equal values (union-find). A mark is a string that identifies a value: its content in a config, or its
/// text in a sweep.
class ValueClasses {
 public:
  /// Puts two marks of the same value into one class.
  void connect(const std::string& a, const std::string& b) { parents_[find(a)] = find(b); }
  /// Returns the mark that represents the class.
  std::string find(const std::string& mark) {
    const auto [at, is_new] = parents_.emplace(mark, mark);
    return is_new || at->second == mark ? mark : at->second = find(at->second);
  }

 private:
  std::map<std::string, std::string> parents_;
};

/// Returns the canonical text of the part of a config at `key`, without the values of other keys; "" if the config has
/// no such part.
std::string identity_at(const Tree& config, const std::string& key, const std::vector<std::string>& keys) {
  const Tree* found = config.find_path(key);
  if (found == nullptr) return {};
  Tree part = *found;
  for (const std::string& other : keys) {
    if (other != key && is_at_or_below(other, key)) part.erase_path(other.substr(key.size() + 1));
  }
  return part.canonical();
}

/// Returns a text for a value that no sweep contains as a text: the name of its group or the type of a plugin. For a
/// scene, the text lists the types of its objects.
std::string words_at(const PooledSetting& setting, const std::string& key) {
  const Tree* found = setting.config.find_path(key);
  if (found == nullptr) return {};
  const std::string path = key + (found->find("type") != nullptr ? ".type" : ".");
  std::string group = found->is_map() ? recorded_group(setting.origins, path, last_key(key)) : std::string();
  if (!group.empty()) return group;
  if (found->is_map() && found->entries.empty()) return "none";
  const Tree* objects = key == "scene" ? found->find("objects") : nullptr;
  if (objects == nullptr) return condition_text(*found);
  std::vector<std::string> types;
  for (const Tree& object : objects->items) {
    if (const Tree* type = object.find("type")) types.push_back(type->text);
  }
  return types.empty() ? "desk" : fmt::format("{}", fmt::join(types, "+"));
}

/// Gives a class of values the name `words`, unless the class has a name already. If another class has this name, the
/// name of the record is appended.
void name_class(const std::string& mark, const std::string& words, const std::string& record,
                std::map<std::string, std::string>& names) {
  if (names.count(mark) > 0) return;
  const auto taken = [&](const std::string& name) {
    return std::any_of(names.begin(), names.end(), [&](const auto& one) { return one.second == name; });
  };
  std::string name = words;
  if (taken(name)) name = fmt::format("{} ({})", words, record);
  for (int n = 2; taken(name); ++n) name = fmt::format("{} ({} {})", words, record, n);
  names.emplace(mark, std::move(name));
}

}  // namespace

std::vector<std::string> pooled_values(const std::vector<PooledSetting>& settings, const std::string& key,
                                       const std::vector<std::string>& keys) {
  const bool in_configs = std::any_of(settings.begin(), settings.end(),
                                      [&](const PooledSetting& one) { return one.config.find_path(key) != nullptr; });
  ValueClasses classes;
  std::vector<std::pair<std::string, std::string>> marks;  // mark and text of each setting
  std::map<std::string, std::string> names;                // name of each class; key: mark from ValueClasses::find()
  for (const PooledSetting& one : settings) {
    const auto swept = one.swept.find(key);
    const bool is_swept = swept != one.swept.end();
    std::string words = is_swept ? swept->second : in_configs ? words_at(one, key) : one.record_name;
    const std::string identity = "=" + identity_at(one.config, key, keys);
    const std::string written = is_swept ? fmt::format("{} {}", one.record, words) : identity;
    if (!in_configs) {
      marks.emplace_back(words, words);
      continue;
    }
    classes.connect(written, identity);
    marks.emplace_back(written, std::move(words));
  }
  // The text of a sweep has priority over a text made from a config.
  for (const bool swept : {true, false}) {
    for (std::size_t i = 0; i < settings.size(); ++i) {
      if ((settings[i].swept.count(key) > 0) != swept) continue;
      name_class(classes.find(marks[i].first), marks[i].second, settings[i].record_name, names);
    }
  }
  std::vector<std::string> out;
  for (const auto& [mark, words] : marks) out.push_back(names.at(classes.find(mark)));
  return out;
}

}  // namespace palpate
