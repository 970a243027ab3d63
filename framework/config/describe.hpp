// SPDX-License-Identifier: MIT
// Descriptions of options, as text for people and as JSON Schema for editors.
#pragma once

#include "config/tree.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// The description of one field of an options struct.
struct FieldDescription {
  enum class Type { real, reals, table, integer, flag, text, choice, section, sections, plugin, plugins };
  struct CaseDescription;

  std::string name;
  Type type = Type::real;
  Unit unit = Unit::none;
  std::string range;          ///< for example "> 0 m" or "0 .. 1"; "" for no limits
  std::string default_value;  ///< text as in a config; "" for no default
  std::string meaning;
  std::string source;
  bool required = false;
  bool optional = false;  ///< whether a `section` is absent by default
  bool group = false;     ///< see Field::group()
  bool adopted = false;   ///< whether the chosen plugin's options follow among the same keys: see Fields::adopt()
  bool drawable = false;  ///< see Field::drawable()
  std::string heir_of;    ///< see Field::inherits(); "": none
  Owner owner = Owner::unsaid;
  std::string beside;                    ///< see Field::with_beside(); "": none
  std::string neutral;                   ///< see Field::neutral(); "none" for absent, "" for no neutral value
  std::size_t count = 0;                 ///< number of values of `reals`, or of each row of a `table`
  std::string kind;                      ///< kind of a `plugin`
  std::vector<CaseDescription> cases;    ///< cases of a `choice`
  std::vector<FieldDescription> fields;  ///< fields of a `section` or of `sections`

  /// Returns for example "length", "whole number" or "one of a, b".
  std::string type_name() const;
};

struct FieldDescription::CaseDescription {
  std::string name;
  std::string meaning;
  std::vector<FieldDescription> fields;
};

/// Describes the key of a field, without its type, default and nested fields.
FieldDescription describe_key(const Field& field);

/// Describes the sibling key of the plugin at `field` (Field::with_beside()), without its fields.
FieldDescription describe_beside(const FieldDescription& field);

/// Returns all plugins of a kind, with their options.
using PluginCases = std::function<std::vector<FieldDescription::CaseDescription>(const std::string& kind)>;

/// Describes the fields that `list` lists. An adopted field (Fields::adopt()) has one case per plugin that `plugins`
/// returns. If `plugins` returns none, only the kind of the plugins is described.
std::vector<FieldDescription> describe_fields(const std::function<void(Fields&)>& list,
                                              const PluginCases& plugins = {});

/// Returns a text table with one line per field. Nested fields are indented.
std::string describe_text(const std::vector<FieldDescription>& fields);

/// Returns the descriptions for JSON: name, type, unit, range, default, meaning, source, required.
Tree describe_tree(const std::vector<FieldDescription>& fields);

/// Returns a JSON Schema of an object that allows exactly the keys of `fields`. If a field is adopted, the object may
/// also have any other keys. A plugin field refers to "#/definitions/<kind>".
Tree schema_of(const std::vector<FieldDescription>& fields);

}  // namespace palpate
