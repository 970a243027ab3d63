// SPDX-License-Identifier: MIT
#include "sweep/written_config.hpp"

#include "config/yaml.hpp"

#include <algorithm>

namespace palpate {
namespace {

/// Top-level keys, in the order in which a resolved config has them.
std::vector<std::string> ordered_keys(const Tree& base, const Tree& resolved) {
  std::vector<std::string> out;
  for (const Tree* tree : {&resolved, &base}) {
    for (const Tree::Entry& entry : tree->entries) {
      if (base.find(entry.key) == nullptr || entry.key == "name" || entry.key == "sweep") continue;
      if (std::find(out.begin(), out.end(), entry.key) == out.end()) out.push_back(entry.key);
    }
  }
  return out;
}

/// Whether what stands below the top-level key depends on what is chosen in a combination.
bool is_touched(const std::string& top, const std::vector<std::string>& swept) {
  return std::any_of(swept.begin(), swept.end(), [&](const std::string& key) {
    if (key == kStrategy) return true;
    for (const std::string& heir : config_keys().heirs_of(key)) {
      if (first_key(heir) == top) return true;
    }
    return first_key(key) == top && is_choice(key);
  });
}

void erase_path(Tree& tree, const std::string& path) {
  const auto dot = path.rfind('.');
  Tree* parent = dot == std::string::npos ? &tree : const_cast<Tree*>(tree.find_path(path.substr(0, dot)));
  if (parent != nullptr) parent->erase(path.substr(dot == std::string::npos ? 0 : dot + 1));
}

}  // namespace

Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const SweepDescription& description, const ResolvedConfig& first) {
  const Tree own = read_yaml(file);
  // Without the options that its own plugins leave out.
  Tree settled = base;
  if (alone) {
    for (const ResolveNotes::Origin& one : alone->notes.dropped) erase_path(settled, one.path);
  }
  const auto is_own = [&](const std::string& top) {
    return top != "expect" && (!alone || is_touched(top, description.keys()));
  };
  Tree out = Tree::map();
  const Tree* name = base.find("name");
  out.at("name") = Tree::scalar(name != nullptr ? name->text : first.options.name, true);
  // What of the groups below is a strategy's cannot be told any more: where any of it is needed all of it is.
  const bool needs_strategy = !alone || std::any_of(description.keys().begin(), description.keys().end(), is_choice);
  Tree kept = Tree::list();
  if (const Tree* defaults = own.find("defaults")) {
    for (const Tree& item : defaults->items) {
      const std::string group = first_key(item.entries.front().key);
      if (group == kStrategy ? needs_strategy : is_own(group)) kept.items.push_back(item);
    }
  }
  if (const Tree* strategy = own.find(kStrategy); strategy != nullptr && needs_strategy) {
    kept.items.push_back(Tree::map());
    kept.items.back().at(kStrategy) = *strategy;
  }
  if (!kept.items.empty()) out.at("defaults") = std::move(kept);
  for (const std::string& top : ordered_keys(base, first.tree)) {
    const Tree* said = is_own(top) ? own.find(top) : settled.find(top);
    if (said != nullptr) out.at(top) = *said;
  }
  out.at("sweep") = description.written();
  return out;
}

}  // namespace palpate
