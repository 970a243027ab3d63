// SPDX-License-Identifier: MIT
#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace palpate {

std::string SourceLocation::text() const {
  if (!file) return {};
  if (line == 0) return *file;
  return fmt::format("{}:{}:{}", *file, line, column);
}

std::string place_in(const std::string& file, std::string_view text, std::size_t bytes) {
  const std::string_view before = text.substr(0, bytes);
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  return fmt::format("{}:{}:{}", file, line, before.size() - (before.rfind('\n') + 1) + 1);
}

Tree Tree::scalar(std::string text, bool quoted) {
  Tree tree(Kind::scalar);
  tree.text = std::move(text);
  tree.quoted = quoted;
  return tree;
}

Tree Tree::list(std::vector<Tree> items) {
  Tree tree(Kind::list);
  tree.items = std::move(items);
  return tree;
}

Tree Tree::map(std::initializer_list<std::pair<const char*, Tree>> entries) {
  Tree tree(Kind::map);
  for (const auto& [key, value] : entries) tree.entries.push_back({key, {}, value});
  return tree;
}

const Tree* Tree::find(std::string_view key) const {
  for (const Entry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

Tree* Tree::find(std::string_view key) { return const_cast<Tree*>(std::as_const(*this).find(key)); }

Tree& Tree::at(std::string_view key) {
  if (Tree* found = find(key)) return *found;
  kind = Kind::map;
  entries.push_back({std::string(key), place, Tree{}});
  entries.back().value.place = place;
  return entries.back().value;
}

void Tree::erase(std::string_view key) {
  entries.erase(std::remove_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == key; }),
                entries.end());
}

void Tree::erase_path(std::string_view path) {
  const auto dot = path.rfind('.');
  if (dot == std::string_view::npos) return erase(path);
  if (const Tree* const inner = find_path(path.substr(0, dot))) const_cast<Tree*>(inner)->erase(path.substr(dot + 1));
}

namespace {

/// Splits "a.b.c" into "a" and "b.c".
std::pair<std::string_view, std::string_view> split_path(std::string_view path) {
  const auto dot = path.find('.');
  if (dot == std::string_view::npos) return {path, {}};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

/// Returns the item of a list whose index is the text `name`, or null.
const Tree* find_item(const Tree& list, std::string_view name) {
  std::size_t index = 0;
  const auto parsed = std::from_chars(name.data(), name.data() + name.size(), index);
  const bool counts = parsed.ec == std::errc() && parsed.ptr == name.data() + name.size();
  return counts && index < list.items.size() ? &list.items[index] : nullptr;
}

const Tree* find_child(const Tree& tree, std::string_view name) {
  return tree.kind == Tree::Kind::list ? find_item(tree, name) : tree.find(name);
}

/// Returns the edit distance of two texts. A swap of neighbouring characters counts as one edit (optimal string
/// alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

/// Returns the shortest known name that contains `name`, for example first_hit_tap for hit. Returns "" if there is
/// none.
std::string longer_form(std::string_view name, const std::vector<std::string>& known) {
  constexpr std::size_t kLeast = 3;
  std::string best;
  for (const std::string& candidate : known) {
    const bool longer = name.size() >= kLeast && candidate.find(name) != std::string::npos;
    if (longer && (best.empty() || candidate.size() < best.size())) best = candidate;
  }
  return best;
}

}  // namespace

const Tree* Tree::find_path(std::string_view path) const {
  if (const Tree* whole = find(path)) return whole;
  const auto [head, rest] = split_path(path);
  const Tree* child = find_child(*this, head);
  return child == nullptr || rest.empty() ? child : child->find_path(rest);
}

Tree::Slot Tree::slot(std::string_view path, const SourceLocation& asker) {
  Tree* holder = nullptr;
  Tree* tree = this;
  for (std::string_view rest = path; !rest.empty();) {
    if (Tree* whole = tree->find(rest)) return {tree, *whole};
    const auto [head, tail] = split_path(rest);
    if (tree->kind == Kind::list && find_item(*tree, head) == nullptr)
      throw Error(asker.text(), fmt::format("'{}': the list has no item '{}'", path, head),
                  tree->items.empty() ? "it is empty" : fmt::format("its items are 0 to {}", tree->items.size() - 1));
    if (tree->kind == Kind::scalar)
      throw Error(asker.text(), fmt::format("'{}': there is no '{}' below a value", path, head),
                  fmt::format("the path ends at '{}'", path.substr(0, path.size() - rest.size() - 1)));
    Tree* child = const_cast<Tree*>(find_child(*tree, head));
    if (child == nullptr) {
      child = &tree->at(head);
      tree->entries.back().place = asker;
      child->place = asker;
    }
    holder = std::exchange(tree, child);
    rest = tail;
  }
  return {holder, *tree};
}

Tree& Tree::at_path(std::string_view path, const SourceLocation& asker) { return slot(path, asker).value; }

void Tree::put(std::string_view path, Tree value) {
  const Slot found = slot(path, value.place);
  if (found.holder != nullptr) {
    for (Entry& entry : found.holder->entries) {
      if (&entry.value == &found.value) entry.place = value.place;
    }
  }
  found.value = std::move(value);
}

SourceLocation Tree::place_of(std::string_view path) const {
  SourceLocation best;
  const Tree* tree = this;
  for (std::string_view rest = path; !rest.empty();) {
    const auto [head, tail] = split_path(rest);
    tree = find_child(*tree, head);
    if (tree == nullptr) break;
    if (tree->place.file) best = tree->place;
    rest = tail;
  }
  return best;
}

void Tree::set_layer(Layer value) {
  for_all(*this, [&](Tree& one) { one.layer = value; });
}

void Tree::shift_layer(int steps) {
  for_all(*this, [&](Tree& one) { one.layer += steps; });
}

void Tree::merge(const Tree& upper) {
  if (!is_map() || !upper.is_map()) {
    if (upper.layer >= layer) *this = upper;
    return;
  }
  for (const Entry& entry : upper.entries) {
    const auto mine = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == entry.key; });
    if (mine == entries.end()) {
      entries.push_back(entry);
      continue;
    }
    if (entry.value.layer >= mine->value.layer) mine->place = entry.place;
    mine->value.merge(entry.value);
  }
}

std::string Tree::canonical() const {
  std::string out;
  append_canonical(out);
  return out;
}

void Tree::append_canonical(std::string& out) const {
  switch (kind) {
    case Kind::null:
      out += '~';
      break;
    case Kind::scalar:
      out.append(std::to_string(text.size())).append(":").append(text);
      break;
    case Kind::list:
    case Kind::map:
      out += is_map() ? '{' : '[';
      for (const Tree& item : items) {
        item.append_canonical(out);
        out += ',';
      }
      for (const Entry& entry : entries) {
        out.append(entry.key).append("=");
        entry.value.append_canonical(out);
        out += ',';
      }
      out += is_map() ? '}' : ']';
      break;
  }
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

bool is_one_of(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string nearest(std::string_view name, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, std::min<std::size_t>(name.size(), 64) / 3) + 1;
  if (name.size() > 64) return best;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& known) {
  std::string near = nearest(name, known);
  if (near.empty()) near = longer_form(name, known);
  if (!near.empty()) return fmt::format("did you mean '{}'?", near);
  if (known.empty()) return {};
  return fmt::format("known: {}", fmt::join(known, ", "));
}

void check_option(const std::string& name, const SourceLocation& place, const std::vector<std::string>& known,
                  const char* block) {
  if (!is_one_of(known, name))
    throw Error(place.text(), fmt::format("unknown option '{}' of {}", name, block), suggestion(name, known));
}

}  // namespace palpate
