// SPDX-License-Identifier: MIT
// Options structs, each with one list of fields. The list has five uses: reading a config strictly, writing the
// resolved config, descriptions of the options, the JSON Schema, and the hash that names a run.
//
// An options struct derives from Options, gives each member its default, and names its fields once:
//
//     struct RbfOptions : Options {
//       double length_scale = 0.017;
//       void list(Fields& fields) override {
//         fields.real(length_scale, Field("length_scale", "distance over which heights are correlated")
//                                       .in(Unit::metre).above(0));
//       }
//     };
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

class Fields;
struct Tree;

/// Dimension of a quantity. In a config, a quantity with a dimension other than `none` has a unit (`1.7 cm`). In the
/// struct, the value is in SI units.
enum class Unit { none, metre, second, newton, radian, metre_per_second, newton_per_metre };

/// A group of options with one field list.
struct Options {
  virtual ~Options() = default;

  /// Lists every field once, in the order in which users see the fields. Each call must list the same fields, except
  /// that the value of a choice may decide the fields after it.
  virtual void list(Fields& fields) = 0;
};

/// Options of a plugin without options.
struct NoOptions : Options {
  void list(Fields&) override {}
};

/// Choice of a plugin in a config: `{type: rbf, length_scale: 1.7 cm}`. Fields::plugin sets it, and Context::create
/// makes an object from it.
struct PluginChoice {
  std::string kind;                     ///< "kernel", "acquisition", ...
  std::string type;                     ///< name of the plugin
  std::shared_ptr<const Tree> options;  ///< options, checked and complete
};

/// Marks the value of an absent optional field, or of an empty list.
struct NoValue {};

/// A constant value of a field, for example a real number in SI units or the name of a case.
struct FixedValue {
  enum class Kind { none, absent, real, integer, flag, text };
  FixedValue() = default;
  FixedValue(NoValue) : kind(Kind::absent) {}
  FixedValue(double value) : kind(Kind::real), real(value) {}
  FixedValue(std::int64_t value) : kind(Kind::integer), real(static_cast<double>(value)), integer(value) {}
  FixedValue(int value) : FixedValue(std::int64_t{value}) {}
  FixedValue(bool value) : kind(Kind::flag), flag(value) {}
  FixedValue(const char* value) : kind(Kind::text), text(value) {}

  Kind kind = Kind::none;
  double real = 0.0;
  std::int64_t integer = 0;
  bool flag = false;
  const char* text = "";
};

/// Owner of a key of a config. A strategy sets the choice of taps and the models. The run sets the world, the
/// candidates, the budget, and the record.
enum class Owner { unsaid, strategy, run };

/// Description of one field, without its value.
class Field {
 public:
  /// `key` is the name in the config, `sentence` the meaning without a full stop. Both must outlive the call.
  Field(const char* key, const char* sentence) : name(key), meaning(sentence) {}

  /// Sets the dimension; default `none`.
  Field& in(Unit dimension) { return unit = dimension, *this; }
  /// Set the range: above `bound`, at least `bound`, at most `bound`, or from `low` to `high`.
  Field& above(double bound) { return least = bound, open_below = true, *this; }
  Field& at_least(double bound) { return least = bound, open_below = false, *this; }
  Field& at_most(double bound) { return most = bound, *this; }
  Field& within(double low, double high) { return at_least(low).at_most(high); }
  /// Sets the source of the default: a paper, a data sheet, a measurement.
  Field& from(const char* text) { return source = text, *this; }
  /// Removes the default: a config must set the field.
  Field& needed() { return required = true, *this; }
  /// Makes the field a group. A name instead of a value chooses a file from the folder of the key's name: `kernel: rbf`
  /// reads kernel/rbf.yaml.
  Field& group() { return is_group = true, *this; }
  /// Takes missing values from the key at `path`, a path from the top level.
  Field& inherits(const char* path) { return heir_of = path, *this; }
  /// Set the owner. Every top-level key of a config needs an owner.
  Field& of_strategy() { return owner = Owner::strategy, *this; }
  Field& of_run() { return owner = Owner::run, *this; }
  /// For a plugin field: moves the plugin's option group with the name `option` out of the plugin's block, to a key of
  /// its own on the same level. Example: the options `motion` of a backend are at the key `motion`, outside the block
  /// `backend`. The group belongs to the run; a strategy may set its default.
  Field& with_beside(const char* option) { return beside = option, *this; }

  /// Sets the neutral value, with which a run is the same as before the option existed. An option with this value does
  /// not enter the id, and a record without the option is read as if it had this value. Every option that is added
  /// after version 0.1.0 has a neutral value, which never changes. A plugin field that is added later is optional, and
  /// its absence is neutral.
  Field& neutral(const FixedValue& value) { return neutral_value = value, *this; }
  /// Keeps the field and its nested fields out of the id, because they change no result of a run.
  Field& not_identifying() { return enters_id = false, *this; }
  /// Makes the text a file name. A relative name is searched in the working folder, then in the folder of the config
  /// that sets it, then in the folders above.
  Field& names_file() { return is_file = true, *this; }
  /// Sets the former name, which the option had in version 0.1.0 or later. The option enters ids under its former name,
  /// and records may contain this name.
  Field& was(const char* key) { return former_name = key, *this; }

  /// Allows `{draw: {least, most, of}}` instead of the list: the items are then drawn at random, depending on the seed.
  Field& drawable() { return is_drawable = true, *this; }

  const char* name;
  const char* meaning;
  const char* source = "";
  Unit unit = Unit::none;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool open_below = false;
  bool required = false;
  bool is_group = false;
  bool is_drawable = false;
  bool is_file = false;
  FixedValue neutral_value;
  bool enters_id = true;
  const char* former_name = "";
  const char* heir_of = "";
  Owner owner = Owner::unsaid;
  const char* beside = "";
};

/// A named value of a choice. A choice with the key `type` may have additional fields for each value.
struct Case {
  const char* name;
  const char* meaning;
  std::function<void(Fields&)> list;  ///< lists the fields of this value; may be empty
};

/// Access to a list of sections, independent of its container.
struct ListAccess {
  std::function<void(std::size_t)> resize;
  std::function<std::size_t()> size;
  std::function<Options&(std::size_t)> item;
};

/// Visitor of the fields of an options struct. The framework implements it once per use; authors of plugins call it. A
/// visitor that reads a config throws Error with file, line and column for an unknown key, a value of the wrong type, a
/// missing unit or a value out of range.
class Fields {
 public:
  virtual ~Fields() = default;

  /// Visits a real number, finite and within the field's range.
  virtual void real(double& value, const Field& field) = 0;
  /// Visits an optional real number, `none` in a config if absent.
  virtual void real(std::optional<double>& value, const Field& field) = 0;
  /// Visits `count` real numbers of one dimension, written as a list.
  virtual void reals(double* values, std::size_t count, const Field& field) = 0;
  /// Visits rows of `columns` real numbers of one dimension, written as a list of lists. `values` has the rows of the
  /// config one after the other.
  virtual void table(std::vector<double>& values, std::size_t columns, const Field& field) = 0;
  virtual void integer(std::int64_t& value, const Field& field) = 0;
  virtual void integer(std::optional<std::int64_t>& value, const Field& field) = 0;
  /// Visits `true` or `false`.
  virtual void flag(bool& value, const Field& field) = 0;
  virtual void text(std::string& value, const Field& field) = 0;
  /// Visits one of several names; `index` is its position in `cases`. The fields of this case follow.
  virtual void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) = 0;
  /// Visits a nested group of options.
  virtual void section(Options& options, const Field& field) = 0;
  /// Visits an optional nested group. In a config, `{}` is the group with its defaults, `none` is no group.
  virtual void section(bool& present, Options& options, const Field& field) = 0;
  /// Visits a list of groups of options.
  virtual void sections(const ListAccess& access, const Field& field) = 0;
  /// Visits another plugin, of the kind `choice.kind`.
  virtual void plugin(PluginChoice& choice, const Field& field) = 0;
  virtual void plugin(std::optional<PluginChoice>& choice, const char* kind, const Field& field) = 0;
  /// Visits a list of plugins of one kind.
  virtual void plugins(std::vector<PluginChoice>& choices, const char* kind, const Field& field) = 0;
  /// Visits another plugin whose options are listed among the present fields, not in a group of their own. `field` is
  /// required, and its value is the name of the plugin. Throws Error if an option of the plugin has the name of a
  /// present field.
  virtual void adopt(PluginChoice& choice, const Field& field) = 0;
  /// Declares a removed option of version 0.1.0 or later, whose last default was `last`. The value `last` still enters
  /// the id, and a record may contain the option with this value. Other values are errors, with `field.meaning` as the
  /// hint.
  virtual void retired(const Field& /*field*/, const FixedValue& /*last*/) {}
  /// Checks a condition between fields. If `holds` is false, reading fails with `reason` at the position of `field`,
  /// which may be a dotted path to a nested field.
  virtual void require(bool holds, const char* field, const std::string& reason) = 0;

  /// Visits a choice stored as an enumeration: `cases` name the values 0, 1, 2, ... in order.
  template <class Enum>
  void choice(Enum& value, const Field& field, const std::vector<Case>& cases) {
    auto index = static_cast<std::size_t>(value);
    choice(index, field, cases);
    value = static_cast<Enum>(index);
  }

  /// Visits an optional group.
  template <class Group>
  void section(std::optional<Group>& group, const Field& field) {
    bool present = group.has_value();
    Group options = group.value_or(Group{});
    section(present, options, field);
    group = present ? std::optional<Group>(std::move(options)) : std::nullopt;
  }

  /// Visits a table with rows of fixed length.
  template <std::size_t columns>
  void table(std::vector<std::array<double, columns>>& rows, const Field& field) {
    std::vector<double> values;
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    table(values, columns, field);
    rows.resize(values.size() / columns);
    for (std::size_t i = 0; i < values.size(); ++i) rows[i / columns][i % columns] = values[i];
  }

  /// Visits a list of groups stored in a vector.
  template <class Item>
  void sections(std::vector<Item>& items, const Field& field) {
    sections(ListAccess{[&](std::size_t size) { items.resize(size); }, [&] { return items.size(); },
                        [&](std::size_t i) -> Options& { return items[i]; }},
             field);
  }
};

}  // namespace palpate
