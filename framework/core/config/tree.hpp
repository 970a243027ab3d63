// SPDX-License-Identifier: MIT
// A config as read: scalars, lists and maps, each with the place it came from. All other code sees configs, records
// and sweeps as trees; only yaml.cpp and json.cpp know the formats.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Where a value was written. Lines and columns count from 1; 0 means the whole file.
struct Place {
  std::shared_ptr<const std::string> file;  ///< path as the user would name it, or "command line"; may be null
  int line = 0;
  int column = 0;

  /// "file:line:column", or as much of it as is known.
  std::string text() const;
};

/// "file:line:column" of what lies behind so many bytes of a file's text.
std::string place_in(const std::string& file, std::string_view text, std::size_t bytes);

/// Who has the last word when two sources say the same thing: the higher layer. Groups named under `defaults` count
/// up from 0 in their order.
using Layer = int;
constexpr Layer kGroupLayer = 0;
constexpr Layer kFileLayer = 1000;
constexpr Layer kSweepLayer = 2000;
constexpr Layer kCommandLineLayer = 3000;

/// A value in a config.
struct Tree {
  enum class Kind { null, scalar, list, map };
  struct Entry;

  Kind kind = Kind::null;
  std::string text;            ///< of a scalar, as written
  bool quoted = false;         ///< the scalar stood in quotes: it is text whatever it looks like
  std::vector<Tree> items;     ///< of a list
  std::vector<Entry> entries;  ///< of a map, in the order written, keys unique
  Place place;
  Layer layer = kFileLayer;
  bool complete = false;  ///< a map of a record, which has every option that the palpate knew that wrote it

  Tree() = default;
  explicit Tree(Kind of) : kind(of) {}
  static Tree scalar(std::string text, bool quoted = false);
  /// A scalar that is text whatever it looks like.
  static Tree quote(std::string text) { return scalar(std::move(text), true); }
  static Tree list(std::vector<Tree> items = {});
  static Tree map(std::initializer_list<std::pair<const char*, Tree>> entries = {});

  bool is_map() const { return kind == Kind::map; }
  bool is_scalar() const { return kind == Kind::scalar; }

  /// The value at `key` of a map, or null.
  const Tree* find(std::string_view key) const;
  Tree* find(std::string_view key);
  /// The entry at `key`, appended if missing; turns a null into a map.
  Tree& at(std::string_view key);
  void erase(std::string_view key);
  /// Erases what `path`, "kernel.length_scale", leads to.
  void erase_path(std::string_view path);
  /// The value at a dotted path, or null; list items are named by their number from 0. A key may have dots itself
  /// (those of `expect` do): what is left of the path is tried as one key first.
  const Tree* find_path(std::string_view path) const;
  /// The same, but maps on the way are made as needed, with the place of `asker`, who also is to blame in the Error
  /// thrown where a scalar is in the way or a list is shorter.
  Tree& at_path(std::string_view path, const Place& asker);
  /// Puts a value at a dotted path, as at_path(); its key then has the place of the value.
  void put(std::string_view path, Tree value);
  /// The place of the value at a dotted path or, where that has none, of what encloses it; none if nothing is there.
  Place place_of(std::string_view path) const;

  /// Marks this tree and all below as coming from `layer`.
  void set_layer(Layer layer);
  /// Moves this tree and all below by `steps` layers, keeping their order among themselves.
  void shift_layer(int steps);

  /// Lays `upper` over this tree: maps are merged key by key, all else is replaced where upper's layer is not lower.
  /// A key has the place of whoever said it last.
  void merge(const Tree& upper);

  /// One line that is equal for equal values, whatever their places.
  std::string canonical() const;
  /// The same, behind what `out` holds already.
  void append_canonical(std::string& out) const;

 private:
  /// A value and what holds it; no holder where it is the whole tree.
  struct Slot {
    Tree* holder;
    Tree& value;
  };
  /// What at_path() returns, with its holder.
  Slot slot(std::string_view path, const Place& asker);
};

struct Tree::Entry {
  std::string key;
  Place place;  ///< of the key
  Tree value;
};

/// Visits a tree and all below.
template <class AnyTree, class Visit>
void for_all(AnyTree& tree, const Visit& visit) {
  visit(tree);
  for (auto& item : tree.items) for_all(item, visit);
  for (auto& entry : tree.entries) for_all(entry.value, visit);
}

/// Whether `text` can be the name of a plugin or of a file of a group; and what to say if not.
bool is_name(const std::string& text);
inline constexpr const char* kNameHint = "a name has letters, digits, '_' and '-', and no path";

/// The name among `known` that `name` was probably meant to be, or "" when none is near.
std::string nearest(std::string_view name, const std::vector<std::string>& known);

/// "did you mean 'x'?", where x is the nearest name or else the shortest one that has `name` in it, or "known: a, b,
/// c"; "" when there is nothing to offer.
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

}  // namespace palpate
