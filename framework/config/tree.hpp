// SPDX-License-Identifier: MIT
// A config as a tree of scalars, lists and maps with their source locations. Only yaml*.cpp and json.cpp handle YAML
// and JSON; all other code uses trees for configs, records and sweeps.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Location of a value in a file. Lines and columns count from 1; 0 stands for the whole file.
struct SourceLocation {
  std::shared_ptr<const std::string> file;  ///< path for messages, or "command line"; may be null
  int line = 0;
  int column = 0;

  /// Returns "file:line:column", without the parts that are 0.
  std::string text() const;
};

/// Returns "file:line:column" of the position after the first `bytes` bytes of `text`, the text of `file`.
std::string place_in(const std::string& file, std::string_view text, std::size_t bytes);

/// Priority of the source of a value: if several sources set a key, the value on the highest layer is used. Groups in
/// `defaults` have the layers from 0 on, in the order of the list.
using Layer = int;
constexpr Layer kGroupLayer = 0;
constexpr Layer kFileLayer = 1000;
constexpr Layer kSweepLayer = 2000;
constexpr Layer kCommandLineLayer = 3000;

/// A value of a config.
struct Tree {
  enum class Kind { null, scalar, list, map };
  struct Entry;

  Kind kind = Kind::null;
  std::string text;            ///< text of a scalar, as written
  bool quoted = false;         ///< whether the scalar was in quotes; if so, it is a text even if it looks like a number
  std::vector<Tree> items;     ///< items of a list
  std::vector<Entry> entries;  ///< entries of a map, in the written order; keys are unique
  SourceLocation place;
  Layer layer = kFileLayer;
  /// Whether this map is from a record; it has all options of the version that wrote the record.
  bool complete = false;

  Tree() = default;
  explicit Tree(Kind of) : kind(of) {}
  static Tree scalar(std::string text, bool quoted = false);
  /// Returns a scalar that is a text even if it looks like a number.
  static Tree quote(std::string text) { return scalar(std::move(text), true); }
  static Tree list(std::vector<Tree> items = {});
  static Tree map(std::initializer_list<std::pair<const char*, Tree>> entries = {});

  bool is_map() const { return kind == Kind::map; }
  bool is_scalar() const { return kind == Kind::scalar; }

  /// Returns the value at `key` of a map, or null.
  const Tree* find(std::string_view key) const;
  Tree* find(std::string_view key);
  /// Returns the value at `key`, which is appended if missing. Turns a null value into a map.
  Tree& at(std::string_view key);
  void erase(std::string_view key);
  /// Erases the value at a dotted path such as "kernel.length_scale".
  void erase_path(std::string_view path);
  /// Returns the value at a dotted path, or null. Items of a list have numbers from 0. At each map, the whole rest of
  /// the path is first tried as a single key, because keys of `expect` contain dots.
  const Tree* find_path(std::string_view path) const;
  /// Returns the value at a dotted path. Missing maps are created with the source location `asker`. Throws Error, with
  /// this location, if the path leads through a scalar or to a missing item of a list.
  Tree& at_path(std::string_view path, const SourceLocation& asker);
  /// Sets the value at a dotted path; missing maps are created as in at_path(). The key gets the source location of the
  /// value.
  void put(std::string_view path, Tree value);
  /// Returns the source location of the value at a dotted path. If the value is missing or has no location, returns the
  /// location of the nearest map around it that has one; the result is empty if there is none.
  SourceLocation place_of(std::string_view path) const;

  /// Sets the layer of this tree and all values within it.
  void set_layer(Layer layer);
  /// Adds `steps` to the layers of this tree and of all values within it. The order of the layers does not change.
  void shift_layer(int steps);

  /// Merges `upper` into this tree. Maps are merged key by key; any other value is replaced if the layer of `upper` is
  /// not lower. A key that both trees have gets the source location from the tree with the higher layer.
  void merge(const Tree& upper);

  /// Returns one line of text that is the same for equal values, even if their source locations differ.
  std::string canonical() const;
  /// Appends the text of canonical() to `out`.
  void append_canonical(std::string& out) const;

 private:
  /// A value, and the map or list that contains it. `holder` is null if the value is the whole tree.
  struct Slot {
    Tree* holder;
    Tree& value;
  };
  /// Returns the value as at_path() does, together with its container.
  Slot slot(std::string_view path, const SourceLocation& asker);
};

struct Tree::Entry {
  std::string key;
  SourceLocation place;  ///< source location of the key
  Tree value;
};

/// Visits a tree and all values within it.
template <class AnyTree, class Visit>
void for_all(AnyTree& tree, const Visit& visit) {
  visit(tree);
  for (auto& item : tree.items) for_all(item, visit);
  for (auto& entry : tree.entries) for_all(entry.value, visit);
}

/// Returns whether `text` is a valid name of a plugin or a group file. kNameHint is the hint for errors about invalid
/// names.
bool is_name(const std::string& text);
inline constexpr const char* kNameHint = "a name has letters, digits, '_' and '-', and no path";

/// Returns whether `names` contains `name`.
bool is_one_of(const std::vector<std::string>& names, const std::string& name);

/// Returns the known name that is most similar to `name`; "" if none is similar.
std::string nearest(std::string_view name, const std::vector<std::string>& known);

/// Returns the hint "did you mean 'x'?" with the most similar name, or else with the shortest name that contains
/// `name`. If no name is similar or contains `name`, returns "known: a, b, c", or "" if `known` is empty.
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

/// Throws Error, with `place`, unless the block `block` has the option `name`.
void check_option(const std::string& name, const SourceLocation& place, const std::vector<std::string>& known,
                  const char* block);

}  // namespace palpate
