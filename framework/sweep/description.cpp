// SPDX-License-Identifier: MIT
#include "sweep/description.hpp"

#include "experiment/experiment_options.hpp"
#include "sweep/sobol.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace palpate {
namespace {

constexpr std::size_t kMaxCombinations = 1'000'000;
constexpr std::size_t kMaxSettings = 20'000'000;  ///< limit on the number of combinations times keys
/// Layer of a swept group or type. This layer is above the layer of swept options, because a type may lack some of the
/// options.
constexpr Layer kChoiceLayer = kSweepLayer + 1;

/// Returns whether `key` is the group or lies within it.
bool is_below(const std::string& key, const std::string& group) {
  return key == group || boost::starts_with(key, group + ".");
}

SourceLocation place_of(const SweepAxis& axis) { return axis.values.front().place; }

void check_block(const std::string& name, const SourceLocation& place) {
  static const std::vector<std::string> names{"grid", "zip", "list", "sobol", "where"};
  check_option(name, place, names, "sweep");
}

bool is_empty(const Tree& block) {
  return (block.is_map() && block.entries.empty()) || (block.kind == Tree::Kind::list && block.items.empty());
}

/// Returns all combinations of `slower`, each extended by every combination of `faster`.
std::vector<Combination> product(const std::vector<Combination>& slower, const std::vector<Combination>& faster) {
  std::vector<Combination> out;
  for (const Combination& slow : slower) {
    for (const Combination& fast : faster) {
      out.push_back(slow);
      out.back().insert(out.back().end(), fast.begin(), fast.end());
    }
  }
  return out;
}

/// Returns the keys of a map with their values.
std::vector<SweepAxis> read_axes(const Tree& described, const std::string& name, const char* hint, ValueCount& count) {
  if (!described.is_map())
    throw Error(described.place.text(), fmt::format("{}: expects a map of keys to values", name), hint);
  std::vector<SweepAxis> axes;
  for (const Tree::Entry& entry : described.entries)
    axes.push_back({entry.key, expand_values(entry.value, entry.key, count), entry.value});
  return axes;
}

void check_key(const SweepAxis& axis) {
  const std::string place = place_of(axis).text();
  check_path(axis.key, place);
  if (is_below(axis.key, "expect"))
    throw Error(place, fmt::format("{}: expectations cannot be swept", axis.key),
                "write it under 'expect:', which applies to the whole sweep");
  if (is_below(axis.key, "compare"))
    throw Error(place, fmt::format("'{}' cannot be swept", axis.key), "write it under 'compare:'");
  if (is_below(axis.key, "sweep") || axis.key == "defaults")
    throw Error(place, fmt::format("'{}' cannot be swept", axis.key), "list its names, as in kernel: [rbf, matern52]");
}

/// Removes a key of the command line from all blocks except the grid.
void take_out(Tree& blocks, const std::string& key) {
  if (Tree* zip = blocks.find("zip")) zip->erase(key);
  Tree* sobol = blocks.find("sobol");
  if (Tree* ranges = sobol != nullptr ? sobol->find("keys") : nullptr; ranges != nullptr && ranges->find(key)) {
    ranges->erase(key);
    if (ranges->entries.empty()) blocks.erase("sobol");
  }
  Tree* list = blocks.find("list");
  if (list == nullptr) return;
  std::vector<Tree>& items = list->items;
  if (std::none_of(items.begin(), items.end(), [&](const Tree& item) { return item.find(key) != nullptr; })) return;
  for (Tree& item : items) item.erase(key);
  // Remove items that differed only in this key and are now equal.
  std::set<std::string> kept;
  const auto is_twin = [&](const Tree& item) { return !kept.insert(item.canonical()).second; };
  items.erase(std::remove_if(items.begin(), items.end(), is_twin), items.end());
}

}  // namespace

SweepOverrides parse_sweep_words(const std::vector<std::string>& words) {
  check_given_once(words);
  SweepOverrides out;
  ValueCount count;
  for (const std::string& word : words) {
    const std::string path = word.substr(0, word.find('='));
    if (is_below(path, "sweep")) {
      Override block = parse_override(word);
      if (path == "sweep")
        throw Error("command line", "'sweep' cannot be set as a whole", "set its blocks: \"sweep.where=taps > 12\"");
      const std::string name = path.substr(std::string("sweep.").size());
      check_block(name, block.value.place);
      out.blocks.emplace_back(name, std::move(block.value));
      continue;
    }
    if (is_below(path, "compare")) {
      out.expectations.push_back(parse_override(word));
      continue;
    }
    SweepAxis axis = parse_axis(word, count);
    if (!is_below(path, "expect")) {
      out.axes.push_back(std::move(axis));
      continue;
    }
    if (axis.values.size() != 1)
      throw Error(place_of(axis).text(), fmt::format("{}: expectations cannot be swept", axis.key),
                  "give it one value");
    out.expectations.push_back({axis.key, axis.values.front()});
  }
  return out;
}

SweepDescription::Block SweepDescription::read_block(const std::string& name, const Tree& described,
                                                     ValueCount& count) {
  const std::string full = "sweep." + name;
  Block block{name, {}};
  if (name == "list") {
    const char* const hint = "write [{key: value}, {key: value, other: [value, value]}]";
    if (described.kind != Tree::Kind::list)
      throw Error(described.place.text(), full + ": expects a list of settings", hint);
    for (const Tree& item : described.items) block.parts.push_back({read_axes(item, full, hint, count), false});
  } else if (name == "sobol") {
    block.parts.push_back({sobol_axes(described, count), true});
  } else {
    block.parts.push_back(
        {read_axes(described, full, "write seed: range(0,10), one key per line", count), name == "zip"});
  }
  if (name == "zip") {
    const std::vector<SweepAxis>& axes = block.parts.front().axes;
    for (const SweepAxis& axis : axes) {
      if (axis.values.size() == axes.front().values.size()) continue;
      throw Error(place_of(axis).text(),
                  fmt::format("sweep.zip: '{}' has {} values, '{}' has {}", axis.key, axis.values.size(),
                              axes.front().key, axes.front().values.size()),
                  "give all keys the same number of values, or combine them in 'grid'");
    }
  }
  return block;
}

SweepDescription::SweepDescription(const Tree* config, const SweepOverrides& words)
    : written_(config != nullptr ? *config : Tree::map()) {
  if (!written_.is_map())
    throw Error(written_.place.text(), "sweep: expects a map", "write sweep: {grid: {key: [values]}}");
  for (const Tree::Entry& entry : written_.entries) check_block(entry.key, entry.place);
  for (const auto& [name, value] : words.blocks) written_.at(name) = value;
  auto& blocks = written_.entries;
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(), [](const auto& block) { return is_empty(block.value); }),
               blocks.end());
  for (const SweepAxis& axis : words.axes) {
    take_out(written_, axis.key);
    if (written_.find("grid") == nullptr) written_.at("grid") = Tree::map();
    if (Tree& grid = written_.at("grid"); grid.is_map()) grid.at(axis.key) = axis.written;
  }
  ValueCount count;
  for (const Tree::Entry& entry : blocks) {
    if (entry.key != "where") {
      blocks_.push_back(read_block(entry.key, entry.value, count));
      continue;
    }
    const bool many = entry.value.kind == Tree::Kind::list;
    for (const Tree& one : many ? entry.value.items : std::vector<Tree>{entry.value}) where_.emplace_back(one);
  }
  list_keys();
  combine();
}

void SweepDescription::list_keys() {
  std::map<std::string, std::pair<const SweepAxis*, const Block*>> seen;
  for (const Block& block : blocks_) {
    for (const Part& part : block.parts) {
      for (const SweepAxis& axis : part.axes) {
        check_key(axis);
        const auto [twin, is_new] = seen.try_emplace(axis.key, &axis, &block);
        if (is_new) keys_.push_back(axis.key);
        if (twin->second.second == &block) continue;
        throw Error(place_of(axis).text(),
                    fmt::format("'{}' is in sweep.{} and, at {}, in sweep.{}", axis.key, block.name,
                                place_of(*twin->second.first).text(), twin->second.second->name),
                    "write each key in one block only");
      }
    }
  }
}

void SweepDescription::combine() {
  combinations_ = {{}};
  for (const Block& block : blocks_) {
    std::vector<Combination> own;
    for (const Part& part : block.parts) {
      std::vector<Combination> rows{{}};
      for (const SweepAxis& axis : part.axes) {
        const std::size_t size = part.together ? axis.values.size() : rows.size() * axis.values.size();
        const std::size_t all = (own.size() + size) * combinations_.size();
        if (all > kMaxCombinations || all * keys_.size() > kMaxSettings)
          throw Error(place_of(axis).text(),
                      all > kMaxCombinations
                          ? fmt::format("{}: the sweep has more than a million jobs", axis.key)
                          : fmt::format("{}: the sweep has {} jobs of {} keys", axis.key, all, keys_.size()),
                      "use fewer values");
        if (part.together) {
          rows.resize(size);
          for (std::size_t digit = 0; digit < size; ++digit) rows[digit].push_back({&axis, digit});
        } else {
          std::vector<Combination> values;
          for (std::size_t digit = 0; digit < axis.values.size(); ++digit) values.push_back({{&axis, digit}});
          rows = product(rows, values);
        }
      }
      own.insert(own.end(), rows.begin(), rows.end());
    }
    combinations_ = product(combinations_, own);
  }
}

/// Returns whether a choice decides what `name` means: kernel decides kernel.alpha, the type of an object decides its
/// scene.objects.0.length, and a strategy decides nearly all options.
bool SweepDescription::depends(const std::string& name, const std::string& choice) const {
  if (!is_choice(choice)) return false;
  if (choice == kStrategy) return name != choice && config_keys().is_of_strategy(name);
  const std::string scope = config_keys().is_group(choice) ? choice : choice.substr(0, choice.rfind('.'));
  return name != choice && name != scope && config_keys().is_decided(name, scope);
}

bool SweepDescription::wanted(const Combination& combination, const WhereCondition::Values& base) const {
  if (where_.empty()) return true;
  const std::string* place = nullptr;
  const WhereCondition::Values value_of = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
    const auto said = std::find_if(combination.begin(), combination.end(),
                                   [&](const SweptValue& one) { return one.axis->key == name; });
    if (said != combination.end()) return WhereCondition::Value{condition_text(said->value())};
    const bool swept = std::find(keys_.begin(), keys_.end(), name) != keys_.end();
    for (const std::string& choice : keys_) {
      if (!depends(name, choice)) continue;
      if (swept) return WhereCondition::Value{};  // another item of the list sets this name
      // Nearly any word could be the name of a strategy's option, so an unknown word counts as a value.
      if (choice == kStrategy && !base(name)) continue;
      throw Error(*place, fmt::format("'{}' depends on '{}', which is swept", name, choice),
                  fmt::format("sweep it too, or compare '{}'", choice));
    }
    std::optional<WhereCondition::Value> value = base(name);
    return value || !swept ? value : WhereCondition::Value{};
  };
  return std::all_of(where_.begin(), where_.end(), [&](const WhereCondition& where) {
    place = &where.place();
    return where.holds(value_of, keys_);
  });
}

std::string SweepDescription::where_place() const { return where_.empty() ? std::string() : where_.front().place(); }

std::vector<Override> overrides_of(const Combination& combination) {
  std::vector<Override> out;
  for (const SweptValue& setting : combination) {
    out.push_back({setting.axis->key, setting.value()});
    out.back().value.set_layer(is_choice(setting.axis->key) ? kChoiceLayer : kSweepLayer);
  }
  return out;
}

std::string condition_text(const Tree& value) {
  const Tree* type = value.is_map() ? value.find("type") : nullptr;
  return type != nullptr && type->is_scalar() ? type->text : value_text(value);
}

bool is_choice(const std::string& key) {
  return config_keys().is_group(key) || config_keys().is_typed(key) || last_key(key) == "type";
}

}  // namespace palpate
