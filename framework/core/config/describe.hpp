// SPDX-License-Identifier: MIT
// Option lists turned into text for people and into JSON Schema for editors.
#pragma once

#include "config/tree.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// All that is known of one field.
struct FieldDescription {
  enum class Type { real, reals, table, integer, flag, text, choice, section, sections, plugin, plugins };
  struct CaseDescription;

  std::string name;
  Type type = Type::real;
  Unit unit = Unit::none;
  std::string range;          ///< "> 0 m", "0 .. 1", or ""
  std::string default_value;  ///< as it would be written; "" for none
  std::string meaning;
  std::string source;
  bool required = false;
  bool optional = false;  ///< a `section` that is absent unless it is written
  bool group = false;     ///< see Field::group()
  bool adopted = false;   ///< see Fields::adopt(); of a plugin whose options, unknown here, stand beside the field
  bool drawable = false;  ///< see Field::drawable()
  std::string heir_of;    ///< see Field::inherits(); "" for none
  Owner owner = Owner::unsaid;
  std::string beside;                  ///< see Field::with_beside(); "" for none
  std::string neutral;                 ///< see Field::neutral(): as in a config, "none" where it is absent; "" for none
  std::size_t count = 0;               ///< of `reals`, and of a row of `table`
  std::string kind;                    ///< of `plugin`
  std::vector<CaseDescription> cases;  ///< of `choice`
  std::vector<FieldDescription> fields;  ///< of `section` and `sections`

  /// "length", "whole number", "one of a, b", ...
  std::string type_name() const;
};

struct FieldDescription::CaseDescription {
  std::string name;
  std::string meaning;
  std::vector<FieldDescription> fields;
};

/// Of a key that is no option and says nothing but what it is.
FieldDescription describe_key(const Field& field);

/// The option that stands beside the plugin at `field` (Field::with_beside()), its fields unknown.
FieldDescription describe_beside(const FieldDescription& field);

/// Every plugin of a kind, with its options.
using PluginCases = std::function<std::vector<FieldDescription::CaseDescription>(const std::string& kind)>;

/// The description of what `list` lists. A plugin whose options stand among them (Fields::adopt) is one of the cases
/// that `plugins` tells; without it, or if there are none, only its kind is known.
std::vector<FieldDescription> describe_fields(const std::function<void(Fields&)>& list,
                                              const PluginCases& plugins = {});

/// An aligned table, a field a line, nested fields indented by their path.
std::string describe_text(const std::vector<FieldDescription>& fields);

/// The same as a tree to be printed as JSON: name, type, unit, range, default, meaning, source, required.
Tree describe_tree(const std::vector<FieldDescription>& fields);

/// The `properties` of a JSON Schema object that allows exactly `fields`, and any beside an adopted one. A plugin field
/// refers to "#/definitions/<kind>".
Tree schema_of(const std::vector<FieldDescription>& fields);

}  // namespace palpate
