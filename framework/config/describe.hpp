// SPDX-License-Identifier: MIT
// Descriptions of options, as text for people and as JSON Schema for editors.
#pragma once

#include "config/tree.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// The description of one field of an option list.
struct FieldDescription {
  enum class Type { real, reals, table, integer, flag, text, choice, section, sections, plugin, plugins };
  struct CaseDescription;

  std::string name;
  Type type = Type::real;
  Unit unit = Unit::none;
  std::string range;          ///< for example "> 0 m" or "0 .. 1"; "": no limits
  std::string default_value;  ///< text as in a config; "": no default
  std::string meaning;
  std::string source;
  bool required = false;
  bool optional = false;  ///< a `section` that is absent by default
  bool group = false;     ///< see Field::group()
  bool adopted = false;   ///< see Fields::adopt(): the options of the plugin, which are unknown here, follow the field
  bool drawable = false;  ///< see Field::drawable()
  std::string heir_of;    ///< see Field::inherits(); "": none
  Owner owner = Owner::unsaid;
  std::string beside;                    ///< see Field::with_beside(); "": none
  std::string neutral;                   ///< see Field::neutral(); as in a config, "none": absent, "": no neutral value
  std::size_t count = 0;                 ///< number of values of `reals`, or of a row of `table`
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

/// Describes a key that is not an option.
FieldDescription describe_key(const Field& field);

/// Describes the option next to the plugin at `field` (Field::with_beside()), without its fields.
FieldDescription describe_beside(const FieldDescription& field);

/// Returns all plugins of a kind, with their options.
using PluginCases = std::function<std::vector<FieldDescription::CaseDescription>(const std::string& kind)>;

/// Describes the fields that `list` lists. The plugins of an adopted field (Fields::adopt()) are its cases, if
/// `plugins` returns any; otherwise only their kind is described.
std::vector<FieldDescription> describe_fields(const std::function<void(Fields&)>& list,
                                              const PluginCases& plugins = {});

/// Returns a table with one line per field. Nested fields have the path as their name.
std::string describe_text(const std::vector<FieldDescription>& fields);

/// Returns the descriptions for JSON: name, type, unit, range, default, meaning, source, required.
Tree describe_tree(const std::vector<FieldDescription>& fields);

/// Returns a JSON Schema of an object that allows exactly `fields`, or any further keys if a field is adopted. A plugin
/// field refers to "#/definitions/<kind>".
Tree schema_of(const std::vector<FieldDescription>& fields);

}  // namespace palpate
