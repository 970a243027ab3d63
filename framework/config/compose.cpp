// SPDX-License-Identifier: MIT
#include "config/compose.hpp"

#include "config/catch_error.hpp"
#include "config/quantity.hpp"
#include "config/resolve.hpp"
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Number of layers of a group. The content of the group's own file is on the highest of these layers. The groups on
/// which it builds are on the lower ones.
constexpr Layer kLayersOfGroup = 16;

[[noreturn]] void refuse_depth(const SourceLocation& place) {
  throw Error(place.text(), fmt::format("groups are nested more than {} levels deep", kLayersOfGroup),
              "merge them into fewer files");
}

/// Appends a group to `chain`, which contains the groups that led from the config to this group. Throws Error for an
/// invalid name, for a group that is already in the chain, and for a chain of more than kLayersOfGroup groups.
void add_link(const std::string& group, const std::string& name, const SourceLocation& place,
              std::vector<std::string>& chain) {
  if (!is_name(name))
    throw Error(place.text(), fmt::format("'{}' is not a valid name in the group {}", name, group), kNameHint);
  const std::string link = group + "/" + name;
  const bool cyclic = std::find(chain.begin(), chain.end(), link) != chain.end();
  chain.push_back(link);
  if (cyclic) throw Error(place.text(), "defaults form a cycle", fmt::format("{}", fmt::join(chain, " -> ")));
  if (chain.size() > static_cast<std::size_t>(kLayersOfGroup)) refuse_depth(place);
}

/// Throws Error if a group has more than kLayersOfGroup layers. The length of the chain does not suffice for this
/// check, because a base may have been read earlier, with a shorter chain.
void check_layers(const Tree& content, const SourceLocation& place) {
  Layer lowest = 0;
  for_all(content, [&](const Tree& one) { lowest = std::min(lowest, one.layer); });
  if (lowest <= -kLayersOfGroup) refuse_depth(place);
}

template <class Container, class Holds>
void drop(Container& from, const Holds& holds) {
  from.erase(std::remove_if(from.begin(), from.end(), holds), from.end());
}

/// Returns the map `{type: name}` of a plugin that is chosen only by its name.
Tree typed(const Tree& name) {
  Tree out = Tree::map({{"type", name}});
  out.place = name.place;
  out.layer = name.layer;
  return out;
}

/// Sets the layer of the key `type` in a chosen group, and in the groups within it, to `layer`.
void set_layer_of_type(Tree& content, Layer layer, const SourceLocation& place) {
  for (Tree::Entry& entry : content.entries) {
    if (entry.value.is_map()) set_layer_of_type(entry.value, layer, place);
    if (entry.key != "type") continue;
    entry.value.layer = layer;
    if (layer >= kFileLayer) entry.value.place = place;
  }
}

/// Completes groups that inherit from another key (Field::inherits()), so that a config needs to set only the
/// differences.
void inherit_shared(Tree& tree, const ConfigKeys& keys) {
  for (const auto& [heir, from] : keys.heirs()) {
    const Tree* own = tree.find_path(heir);
    const Tree* base = tree.find_path(from);
    if (own == nullptr || base == nullptr || !own->is_map() || !base->is_map()) continue;
    Tree merged = *base;
    // Inherited values get lower layers than all own values.
    merged.shift_layer(-2 * kCommandLineLayer);
    merged.merge(*own);
    merged.place = own->place;
    tree.at_path(heir, own->place) = std::move(merged);
  }
}

}  // namespace

void mark_complete(Tree& config) {
  const Tree* complete = config.find("complete");
  if (complete == nullptr) return;
  std::int64_t number = 0;
  catch_error([&] { number = read_integer(*complete, "complete"); });  // resolve() reports an invalid value later
  if (number > kRecordVersion)
    throw Error(
        complete->place.text(),
        fmt::format("complete: {} is newer than {}, the latest version that this build reads", number, kRecordVersion),
        "use a palpate at least as new as the one that wrote it");
  for_all(config, [](Tree& one) { one.complete = one.is_map(); });
}

bool Composer::is_inner(const std::string& path) const {
  for (auto dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
    if (keys_.is_group(path.substr(0, dot))) return true;
  }
  return false;
}

const Tree& Composer::load(const fs::path& file) {
  if (file.empty()) throw Error("command line", "the name of the config is empty", "name a YAML file");
  const fs::path key = fs::absolute(file).lexically_normal();
  const auto found = loaded_.find(key);
  if (found != loaded_.end()) return found->second;
  Tree tree = read_yaml(file);
  if (!tree.is_map()) throw Error(tree.place.text(), "a config is a map", "write key: value");
  mark_complete(tree);
  return loaded_.emplace(key, std::move(tree)).first->second;
}

std::vector<std::string> Composer::names_of(const std::string& group) const {
  std::vector<std::string> out;
  for (const auto& [name, file] : group_files_.list(group, beside_)) out.push_back(name);
  return out;
}

Tree Composer::group_content(const std::string& group, const std::string& name, const SourceLocation& place,
                             const fs::path& beside, std::vector<std::string>& chain) {
  add_link(group, name, place, chain);
  const fs::path file = group_files_.find(group, name, place, beside);
  if (file.empty() && !keys_.is_plugin(group)) throw group_files_.missing(group, name, place, beside);
  Tree content = Tree::map();
  content.place = place;
  if (file.empty()) {
    content.at("type") = Tree::scalar(name);
    content.at("type").place = place;
  } else {
    Tree own = load(file);
    content.place = own.place;
    own.set_layer(0);
    lay_bases(content, group, take_defaults(own), GroupFiles::root_of(file, group), chain);
    lay_group_file(content, group, own);
    check_layers(content, place);
  }
  chain.pop_back();
  return content;
}

void Composer::lay_bases(Tree& content, const std::string& group, const std::vector<Choice>& bases,
                         const fs::path& beside, std::vector<std::string>& chain) {
  for (std::size_t i = 0; i < bases.size(); ++i) {
    const Choice& base = bases[i];
    if (base.path != group)
      throw Error(base.value.place.text(), fmt::format("a {} may build only on another {}", group, group),
                  fmt::format("write '- {}: name'", group));
    Tree below = base_content(group, base.value, beside, chain);
    below.shift_layer(static_cast<int>(i) - static_cast<int>(bases.size()));
    content.merge(below);
  }
}

void Composer::lay_group_file(Tree& content, const std::string& group, const Tree& own) const {
  const std::string beside_group = keys_.beside(group);
  for (const Tree::Entry& entry : own.entries) {
    const bool is_beside = !beside_group.empty() && entry.key == beside_group;
    if (entry.key != group && !is_beside)
      throw Error(entry.place.text(), fmt::format("unknown key '{}'", entry.key),
                  fmt::format("a file in {}/ holds only '{}:'{}", group, group,
                              beside_group.empty() ? "" : fmt::format(" and '{}:'", beside_group)));
    if (!entry.value.is_map())
      throw Error(entry.place.text(), fmt::format("'{}' is not a group of options", entry.key),
                  is_beside ? "write key: value below it, a name is not accepted here" : "write key: value below it");
    if (is_beside) {
      Tree& slot = content.at(beside_group);
      if (slot.kind == Tree::Kind::null) slot = Tree::map();
      slot.place = entry.value.place;
      slot.merge(entry.value);
    } else {
      check_beside(entry.value, group, beside_group);
      content.merge(entry.value);
    }
  }
}

Tree Composer::base_content(const std::string& group, const Tree& name, const fs::path& beside,
                            std::vector<std::string>& chain) {
  const std::array<std::string, 3> key{group, name.text, beside.string()};
  if (const auto known = bases_.find(key); known != bases_.end()) return known->second;
  Tree content = group_content(group, name.text, name.place, beside, chain);
  // A plugin without a file is not cached: its source location is the place where it is named, which differs between
  // uses.
  if (!group_files_.find(group, name.text, name.place, beside).empty()) bases_.emplace(key, content);
  return content;
}

std::vector<Composer::Choice> Composer::take_defaults(Tree& own) const {
  std::vector<Choice> choices;
  const Tree* defaults = own.find("defaults");
  if (defaults == nullptr) {
    // A misspelt `defaults` is reported first. Otherwise the first error would be about a missing group that the list
    // `defaults` chooses.
    for (const Tree::Entry& entry : own.entries) {
      if (nearest(entry.key, {"defaults"}).empty()) continue;
      throw Error(entry.place.text(), fmt::format("unknown option '{}'", entry.key), "did you mean 'defaults'?");
    }
    return choices;
  }
  if (defaults->kind != Tree::Kind::list)
    throw Error(defaults->place.text(), "defaults: expects a list", "write '- kernel: rbf', one group per line");
  for (const Tree& item : defaults->items) {
    if (!item.is_map() || item.entries.size() != 1 || !item.entries.front().value.is_scalar())
      throw Error(item.place.text(), "defaults: expects '- group: name'", "for example '- kernel: rbf'");
    const Tree::Entry& entry = item.entries.front();
    if (!keys_.is_group(entry.key))
      throw Error(entry.place.text(), fmt::format("unknown group '{}'", entry.key),
                  suggestion(entry.key, keys_.groups()));
    choices.push_back({entry.key, entry.value});
    choices.back().value.layer = kGroupLayer;
  }
  own.erase("defaults");
  return choices;
}

void Composer::take_names(Tree& tree, const std::string& path, std::vector<Choice>& choices) const {
  std::vector<std::string> taken;
  for (Tree::Entry& entry : tree.entries) {
    if (path.empty() && describes_many_runs(entry.key)) continue;
    const std::string here = path.empty() ? entry.key : path + "." + entry.key;
    if (keys_.is_typed(here) && entry.value.is_scalar()) entry.value = typed(entry.value);
    if (keys_.is_group(here) && entry.value.is_scalar()) {
      choices.push_back({here, entry.value});
      taken.push_back(entry.key);
    } else if (entry.value.is_map() && !keys_.is_plugin(here)) {
      take_names(entry.value, here, choices);
    }
  }
  for (const std::string& key : taken) tree.erase(key);
}

Tree Composer::take_group(const Choice& choice, const fs::path& beside, Layer layer) {
  std::vector<std::string> chain;
  Tree content = group_content(last_key(choice.path), choice.value.text, choice.value.place, beside, chain);
  note_group(choice, beside);
  content.shift_layer(layer);
  set_layer_of_type(content, std::max(choice.value.layer, layer), choice.value.place);
  return content;
}

void Composer::lay_groups(Tree& tree, const std::vector<Choice>& choices, const fs::path& beside, Layer& layer) {
  // A group file may also set options of the group's sibling key; for example, a backend file may set options of
  // `motion`. These options are ignored if an override chooses the sibling key. They are also ignored if the config
  // that chooses the group chooses the sibling key, too.
  const auto is_chosen = [&](const std::string& key, Layer since) {
    return std::any_of(choices.begin(), choices.end(), [&](const Choice& one) {
      return one.path == key && (one.value.layer >= kSweepLayer || since < kSweepLayer);
    });
  };
  const auto lay = [&](const Choice& choice) {
    Tree content = take_group(choice, beside, layer);
    layer += kLayersOfGroup;
    const std::string key = keys_.beside(choice.path);
    if (const Tree* const brought = key.empty() ? nullptr : content.find(key)) {
      if (!is_chosen(key, choice.value.layer)) {
        tree.at_path(key, brought->place) = *brought;
        drop(groups_, [&](const Group& one) { return one.path == key; });
      }
      content.erase(key);
    }
    Tree& slot = tree.at_path(choice.path, choice.value.place);
    if (slot.kind == Tree::Kind::null || keys_.is_part(choice.path)) slot = Tree::map();
    if (slot.place.line == 0) slot.place = content.place;
    slot.merge(content);
  };
  // Parts of groups (such as scene.effects) are merged after all whole groups (such as scene). A part replaces
  // everything that the whole group sets at the path of the part.
  for (const bool parts : {false, true}) {
    for (const Choice& choice : choices) {
      if (keys_.is_part(choice.path) == parts) lay(choice);
    }
  }
}

Layer Composer::lay_strategy(Tree& tree, std::vector<Choice>& choices, const fs::path& beside, Layer& layer,
                             std::vector<std::string>& chain) {
  const auto is_strategy = [](const Choice& choice) { return choice.path == kStrategy; };
  const auto last = std::find_if(choices.rbegin(), choices.rend(), is_strategy);
  if (last == choices.rend()) return kGroupLayer;
  const Choice choice = *last;
  drop(choices, is_strategy);
  add_link(kStrategy, choice.value.text, choice.value.place, chain);
  const fs::path file = group_files_.find(kStrategy, choice.value.text, choice.value.place, beside);
  if (file.empty()) throw group_files_.missing(kStrategy, choice.value.text, choice.value.place, beside);
  note_group(choice, beside);
  Tree own = load(file);
  own.set_layer(kGroupLayer);
  std::map<std::string, Tree> brought;
  for (const Tree::Entry& entry : own.entries) {
    if (keys_.is_brought(entry.key) && entry.value.is_map()) brought.emplace(entry.key, entry.value);
  }
  std::vector<Choice> inner = take_defaults(own);
  const auto is_of_run = [&](const std::string& path) {
    return !keys_.is_of_strategy(path) || keys_.is_brought(first_key(path));
  };
  drop(own.entries, [&](const Tree::Entry& one) { return is_of_run(one.key); });
  take_names(own, "", inner);
  drop(inner, [&](const Choice& one) { return is_of_run(one.path); });
  const fs::path root = GroupFiles::root_of(file, kStrategy);
  lay_strategy(tree, inner, root, layer, chain);
  for (auto& [key, part] : brought) brought_[key] = std::move(part);
  lay_groups(tree, inner, root, layer);
  own.set_layer(layer);
  layer += kLayersOfGroup;
  tree.merge(own);
  return choice.value.layer;
}

void Composer::note_group(const Choice& choice, const fs::path& beside) {
  fs::path file = group_files_.find(last_key(choice.path), choice.value.text, choice.value.place, beside);
  if (!file.empty()) groups_.push_back({choice.path, choice.value.text, std::move(file)});
}

std::vector<Composer::Choice> Composer::take_choices(Tree& own, const std::vector<Override>& overrides) const {
  std::vector<Choice> choices = take_defaults(own);
  take_names(own, "", choices);
  for (const Override& one : overrides) {
    if (!keys_.is_group(one.path) || !one.value.is_scalar() || is_inner(one.path)) continue;
    drop(choices, [&](const Choice& choice) { return choice.path == one.path; });
    choices.push_back(one);
  }
  return choices;
}

Tree Composer::compose(const fs::path& named, const std::vector<Override>& overrides) {
  groups_.clear();
  brought_.clear();
  const fs::path file = found(named);
  Tree own = load(file);
  beside_ = fs::absolute(file).parent_path();
  std::vector<Choice> choices = take_choices(own, overrides);
  Tree tree = Tree::map();
  tree.place = own.place;
  Layer layer = kGroupLayer;
  std::vector<std::string> chain;
  if (lay_strategy(tree, choices, beside_, layer, chain) >= kSweepLayer) {
    drop(choices, [&](const Choice& one) { return one.value.layer < kSweepLayer && is_replaced(one.path, own, tree); });
    const Tree before = own;
    for (const Tree::Entry& entry : before.entries) {
      if (is_replaced(entry.key, before, tree)) {
        own.erase(entry.key);
      } else if (keys_.is_typed(entry.key)) {
        drop(own.at(entry.key).entries,
             [&](const Tree::Entry& part) { return is_replaced(entry.key + "." + part.key, before, tree); });
      }
    }
  }
  lay_groups(tree, choices, beside_, layer);
  tree.merge(own);
  tree.complete = own.complete;
  for (const auto& [key, part] : brought_) {
    if (tree.find(key) == nullptr) tree.at_path(key, part.place) = part;
  }
  for (const Override& one : overrides) lay_override(tree, one);
  inherit_shared(tree, keys_);
  return tree;
}

bool Composer::is_replaced(const std::string& path, const Tree& own, const Tree& strategy) const {
  const std::string key = first_key(path);
  const Tree* const replacing = strategy.find(key);
  if (replacing == nullptr) return false;
  const Tree* const replaced = own.find(key);
  if (!keys_.is_typed(key) || (replaced != nullptr && !replaced->is_map())) return true;
  const auto type_of = [&](const Tree* plugin) {
    const Tree* const type = plugin != nullptr ? plugin->find("type") : nullptr;
    return type != nullptr ? type->text : keys_.default_type(key);
  };
  if (type_of(replaced) != type_of(replacing)) return true;
  return path != key && replacing->find(first_key(path.substr(key.size() + 1))) != nullptr;
}

void Composer::lay_override(Tree& tree, const Override& one) {
  const auto& [path, value] = one;
  const bool is_typed = keys_.is_typed(path);
  if (is_typed && value.is_scalar()) return tree.put(path + ".type", value);
  const bool is_group = keys_.is_group(path);
  if (is_group && value.is_scalar()) {
    if (is_inner(path)) choose_inner(tree, one, beside_);
    return;
  }
  Tree& slot = tree.at_path(path, value.place);
  if ((is_typed || (is_group && !keys_.is_part(path))) && slot.is_map() && value.is_map()) {
    slot.merge(value);
  } else {
    tree.put(path, value);
  }
}

void Composer::choose_inner(Tree& tree, const Choice& choice, const fs::path& beside) {
  Tree& slot = tree.at_path(choice.path, choice.value.place);
  Tree content = take_group(choice, beside, kFileLayer - 1);
  if (slot.is_map() && !keys_.is_part(choice.path)) {
    const Tree* const type = content.find("type");
    const Tree chosen = type != nullptr ? *type : Tree();
    content.merge(slot);
    if (type != nullptr) content.at("type") = chosen;
  }
  slot = std::move(content);
}

}  // namespace palpate
