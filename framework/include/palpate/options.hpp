// SPDX-License-Identifier: MIT
// One list of fields per options struct, and five uses of it: reading a config strictly, writing the resolved config,
// describing the options to people, the JSON Schema, and the hash that names a run.
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

/// The dimension that a quantity has. In a config a quantity of any dimension but `none` carries its unit (`1.7 cm`);
/// in the struct it is SI.
enum class Unit { none, metre, second, newton, radian, metre_per_second, newton_per_metre };

/// A group of options with one field list.
struct Options {
  virtual ~Options() = default;

  /// Names every field once, in the order in which users read them. Must list the same fields at each call, but that
  /// a choice already listed may decide which fields follow.
  virtual void list(Fields& fields) = 0;
};

/// The options of a plugin that has none.
struct NoOptions : Options {
  void list(Fields&) override {}
};

/// The choice of a plugin in a config: `{type: rbf, length_scale: 1.7 cm}`. Filled by Fields::plugin, turned into an
/// object by Context::create.
struct PluginChoice {
  std::string kind;                     ///< "kernel", "acquisition", ...
  std::string type;                     ///< the plugin's name
  std::shared_ptr<const Tree> options;  ///< its options, checked and complete
};

/// Stands for a value that is not there: for none of what may be absent, for no item of a list.
struct NoValue {};

/// A value written down in code: of a real number in SI, of a choice its name.
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

/// Who sets a key of a config: a strategy, which decides where to tap and what is believed, or the run alone: the
/// world, how it is divided, the budget, and what is kept.
enum class Owner { unsaid, strategy, run };

/// What is said about one field: everything but its value.
class Field {
 public:
  /// `key` is the name in the config, `sentence` its meaning without a full stop. Both must outlive the call.
  Field(const char* key, const char* sentence) : name(key), meaning(sentence) {}

  /// Its dimension; `none` if not said.
  Field& in(Unit dimension) { return unit = dimension, *this; }
  /// Its range: open below at `bound`, or closed below, or closed above.
  Field& above(double bound) { return least = bound, open_below = true, *this; }
  Field& at_least(double bound) { return least = bound, open_below = false, *this; }
  Field& at_most(double bound) { return most = bound, *this; }
  /// Where the default comes from: a paper, a data sheet, a measurement.
  Field& from(const char* text) { return source = text, *this; }
  /// No default: a config must say it.
  Field& needed() { return required = true, *this; }
  /// A name in the place of its value chooses a file, from the folder that is called like the key: `kernel: rbf` reads
  /// kernel/rbf.yaml.
  Field& group() { return is_group = true, *this; }
  /// What it does not say of its own, the key at `path` says, a path from the top.
  Field& inherits(const char* path) { return heir_of = path, *this; }
  /// Whose it is; every top-level key of a config says one of the two.
  Field& of_strategy() { return owner = Owner::strategy, *this; }
  Field& of_run() { return owner = Owner::run, *this; }
  /// Of a plugin: its group of options with this name does not stand within the plugin's block but beside it, as a
  /// group of its own. It is the run's, and a strategy may bring it along for runs that do not say it.
  Field& with_beside(const char* option) { return beside = option, *this; }

  /// The value with which a run is the same as before the option existed. An option that has it does not enter the id,
  /// and a record that lacks the option is read with it. Every option that was added after version 0.1.0 declares one,
  /// and it never changes. Plugins that were added are optional: they are neutral where they are absent.
  Field& neutral(const FixedValue& value) { return neutral_value = value, *this; }
  /// Changes no result of a run, and enters no id; nor does anything below it.
  Field& not_identifying() { return enters_id = false, *this; }
  /// A text that names a file. Where there is none of a relative name in the working folder, the one beside the config
  /// that says it counts, or in a folder above that.
  Field& names_file() { return is_file = true, *this; }
  /// The name that the option had up to some version after 0.1.0. It enters ids by that name, and records may have it.
  Field& was(const char* key) { return former_name = key, *this; }

  /// A list, in whose place `{draw: {least, most, of}}` may stand: items that are drawn from the seed.
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

/// One of the named values of a choice. A choice that is a `type` may bring fields of its own.
struct Case {
  const char* name;
  const char* meaning;
  std::function<void(Fields&)> list;  ///< the fields that come with this value, beside the choice; may be empty
};

/// Access to a list of sections without naming the container.
struct ListAccess {
  std::function<void(std::size_t)> resize;
  std::function<std::size_t()> size;
  std::function<Options&(std::size_t)> item;
};

/// Visits the fields of an options struct. The framework implements it once per use; authors only call it.
/// A visitor that reads a config throws Error with file, line, column for an unknown key, a value of the wrong type, a
/// missing unit or a value out of range.
class Fields {
 public:
  virtual ~Fields() = default;

  /// A real number; finite, within the field's range.
  virtual void real(double& value, const Field& field) = 0;
  /// A real number that may be absent. `none` stands for absent in a config.
  virtual void real(std::optional<double>& value, const Field& field) = 0;
  /// `count` real numbers of one dimension, written as a list.
  virtual void reals(double* values, std::size_t count, const Field& field) = 0;
  /// Rows of `columns` real numbers of one dimension each, written as a list of lists; `values` holds row after row,
  /// and has as many rows as the config.
  virtual void table(std::vector<double>& values, std::size_t columns, const Field& field) = 0;
  virtual void integer(std::int64_t& value, const Field& field) = 0;
  virtual void integer(std::optional<std::int64_t>& value, const Field& field) = 0;
  /// `true` or `false`.
  virtual void flag(bool& value, const Field& field) = 0;
  virtual void text(std::string& value, const Field& field) = 0;
  /// One of several names; `index` is its position in `cases`. Fields of the chosen case follow.
  virtual void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) = 0;
  /// A nested group of options.
  virtual void section(Options& options, const Field& field) = 0;
  /// A nested group that may be absent. In a config `{}` stands for the group with its defaults, `none` for no group.
  virtual void section(bool& present, Options& options, const Field& field) = 0;
  /// A list of groups of options.
  virtual void sections(const ListAccess& access, const Field& field) = 0;
  /// Another plugin, of the kind `choice.kind`.
  virtual void plugin(PluginChoice& choice, const Field& field) = 0;
  virtual void plugin(std::optional<PluginChoice>& choice, const char* kind, const Field& field) = 0;
  /// A list of plugins of one kind.
  virtual void plugins(std::vector<PluginChoice>& choices, const char* kind, const Field& field) = 0;
  /// Another plugin, whose name and options stand among the fields at hand instead of in a group of their own: the
  /// needed `field` names it. Throws Error where one of its options has the name of a field beside it.
  virtual void adopt(PluginChoice& choice, const Field& field) = 0;
  /// An option that versions from 0.1.0 on had, whose default was `last`: that enters the id as if it were there, and a
  /// record may have this value. All else is refused, and `field.meaning` says what to write now.
  virtual void retired(const Field& /*field*/, const FixedValue& /*last*/) {}
  /// A law between fields: when `holds` is false, reading fails with `reason` at the place of `field`, which may be a
  /// dotted path to a field of a nested group.
  virtual void require(bool holds, const char* field, const std::string& reason) = 0;

  /// A choice stored as an enumeration: `cases` name the values 0, 1, 2, ... in order.
  template <class Enum>
  void choice(Enum& value, const Field& field, const std::vector<Case>& cases) {
    auto index = static_cast<std::size_t>(value);
    choice(index, field, cases);
    value = static_cast<Enum>(index);
  }

  /// A group that may be absent.
  template <class Group>
  void section(std::optional<Group>& group, const Field& field) {
    bool present = group.has_value();
    Group options = group.value_or(Group{});
    section(present, options, field);
    group = present ? std::optional<Group>(std::move(options)) : std::nullopt;
  }

  /// A table whose rows are points.
  template <std::size_t columns>
  void table(std::vector<std::array<double, columns>>& rows, const Field& field) {
    std::vector<double> values;
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    table(values, columns, field);
    rows.resize(values.size() / columns);
    for (std::size_t i = 0; i < values.size(); ++i) rows[i / columns][i % columns] = values[i];
  }

  /// A list of groups stored in a vector.
  template <class Item>
  void sections(std::vector<Item>& items, const Field& field) {
    sections(ListAccess{[&](std::size_t size) { items.resize(size); }, [&] { return items.size(); },
                        [&](std::size_t i) -> Options& { return items[i]; }},
             field);
  }
};

}  // namespace palpate
