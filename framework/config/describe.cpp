// SPDX-License-Identifier: MIT
#include "config/describe.hpp"

#include "config/expand.hpp"
#include "config/quantity.hpp"
#include "config/text_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

using Type = FieldDescription::Type;

std::string range_text(const Field& field) {
  const bool low = std::isfinite(field.least);
  const bool high = std::isfinite(field.most);
  if (low && high) return fmt::format("{} .. {}", field.least, write_quantity(field.most, field.unit));
  if (low) return fmt::format("{} {}", field.open_below ? ">" : ">=", write_quantity(field.least, field.unit));
  if (high) return fmt::format("<= {}", write_quantity(field.most, field.unit));
  return {};
}

class Describer final : public Fields {
 public:
  explicit Describer(const PluginCases& plugins) : plugins_(plugins) {
    constexpr std::size_t kUsual =
        16;  // usual number of fields, reserved to save time, because a first run describes hundreds of options
    rows.reserve(kUsual);
  }

  std::vector<FieldDescription> rows;

  void real(double& value, const Field& field) override {
    add(Type::real, field).default_value = write_quantity(value, field.unit);
  }
  void real(std::optional<double>& value, const Field& field) override {
    add(Type::real, field).default_value = value ? write_quantity(*value, field.unit) : "none";
  }
  void reals(double* values, std::size_t count, const Field& field) override {
    FieldDescription& row = add(Type::reals, field);
    row.count = count;
    row.default_value = value_text(write_quantities(values, count, field.unit));
  }
  void table(std::vector<double>& values, std::size_t columns, const Field& field) override {
    FieldDescription& row = add(Type::table, field);
    row.count = columns;
    row.default_value = value_text(write_table(values, columns, field.unit));
  }
  void integer(std::int64_t& value, const Field& field) override {
    add(Type::integer, field).default_value = std::to_string(value);
  }
  void integer(std::optional<std::int64_t>& value, const Field& field) override {
    add(Type::integer, field).default_value = value ? std::to_string(*value) : "none";
  }
  void flag(bool& value, const Field& field) override {
    add(Type::flag, field).default_value = value ? "true" : "false";
  }
  void text(std::string& value, const Field& field) override { add(Type::text, field).default_value = value; }

  void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) override {
    FieldDescription& row = add(Type::choice, field);
    row.default_value = cases[index].name;
    for (const Case& one : cases) {
      row.cases.push_back({one.name, one.meaning, {}});
      if (one.list) row.cases.back().fields = describe_fields(one.list, plugins_);
    }
  }
  void section(Options& options, const Field& field) override {
    add(Type::section, field).fields = describe_fields([&](Fields& fields) { options.list(fields); }, plugins_);
  }
  void section(bool& present, Options& options, const Field& field) override {
    section(options, field);
    rows.back().optional = !present;
  }
  void sections(const ListAccess& access, const Field& field) override {
    access.resize(1);
    add(Type::sections, field).fields = describe_fields([&](Fields& fields) { access.item(0).list(fields); }, plugins_);
    access.resize(0);
  }
  void plugin(PluginChoice& choice, const Field& field) override {
    FieldDescription& row = add(Type::plugin, field);
    row.kind = choice.kind;
    row.default_value = choice.type;
  }
  void plugin(std::optional<PluginChoice>&, const char* kind, const Field& field) override {
    add(Type::plugin, field).kind = kind;
  }
  void plugins(std::vector<PluginChoice>&, const char* kind, const Field& field) override {
    add(Type::plugins, field).kind = kind;
  }
  void adopt(PluginChoice& choice, const Field& field) override {
    plugin(choice, field);
    FieldDescription& row = rows.back();
    if (plugins_) row.cases = plugins_(choice.kind);
    if (!row.cases.empty()) row.type = Type::choice;
    row.adopted = row.cases.empty();
  }
  void require(bool, const char*, const std::string&) override {}

 private:
  const PluginCases& plugins_;

  FieldDescription& add(Type type, const Field& field) {
    rows.push_back(describe_key(field));
    rows.back().type = type;
    return rows.back();
  }
};

void append_text(std::vector<std::vector<std::string>>& lines, const std::vector<FieldDescription>& fields,
                 const std::string& prefix) {
  for (const FieldDescription& field : fields) {
    const std::string meaning =
        field.source.empty() ? field.meaning : fmt::format("{} ({})", field.meaning, field.source);
    std::string type = field.type_name();
    if (!field.range.empty()) type += " " + field.range;
    const bool group = field.type == Type::section || field.type == Type::sections;
    lines.push_back({prefix + field.name, type,
                     field.required ? "required"
                     : group        ? (field.optional ? "absent" : "")
                                    : field.default_value,
                     meaning});
    for (const auto& one : field.cases) {
      lines.push_back({prefix + "  " + one.name, "", "", one.meaning});
      append_text(lines, one.fields, prefix + "    ");
    }
    append_text(lines, field.fields, prefix + "  ");
  }
}

/// Returns a regular expression for quantities such as "1.7 cm". With this pattern, an editor can check a value while
/// the user types.
std::string quantity_pattern(Unit unit) {
  return fmt::format("^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)? *({})$", fmt::join(unit_names(unit), "|"));
}

Tree number_schema(Unit unit) {
  if (unit == Unit::none) return Tree::map({{"type", Tree::quote("number")}});
  return Tree::map({{"type", Tree::quote("string")}, {"pattern", Tree::quote(quantity_pattern(unit))}});
}

/// Returns a reference to the schema of a plugin kind.
Tree plugin_schema(const std::string& kind) { return Tree::map({{"$ref", Tree::quote("#/definitions/" + kind)}}); }

Tree array_schema(Tree items) { return Tree::map({{"type", Tree::quote("array")}, {"items", std::move(items)}}); }

/// Returns the schema of one row of values of `field`, including the number of values.
Tree row_schema(const FieldDescription& field) {
  Tree out = array_schema(number_schema(field.unit));
  for (const char* bound : {"minItems", "maxItems"}) out.at(bound) = Tree::scalar(std::to_string(field.count));
  return out;
}

/// Returns the schema of a group of fields. If a field is a choice with fields per case, the schema has one alternative
/// per case, which allows only the fields of this case.
Tree group_schema(const std::vector<FieldDescription>& fields) {
  const auto typed = std::find_if(fields.begin(), fields.end(), [](const FieldDescription& field) {
    return std::any_of(field.cases.begin(), field.cases.end(), [](const auto& one) { return !one.fields.empty(); });
  });
  if (typed == fields.end()) return schema_of(fields);
  Tree any = Tree::list();
  std::vector<FieldDescription> chosen = fields;
  for (const auto& one : typed->cases) {
    chosen[static_cast<std::size_t>(typed - fields.begin())].cases = {one};
    any.items.push_back(schema_of(chosen));
    if (typed->required) any.items.back().at("required") = Tree::list({Tree::quote(typed->name)});
  }
  return Tree::map({{"anyOf", any}});
}

/// Returns the schema of a group. A group with files may be replaced by a file's name, and an optional group by `none`.
Tree section_schema(const FieldDescription& field) {
  Tree group = group_schema(field.fields);
  if (!field.optional && !field.group) return group;
  const Tree name = Tree::map(
      {{"type", Tree::quote("string")},
       {"description", Tree::quote(fmt::format("name of a config group: NAME reads {}/NAME.yaml", field.name))}});
  const Tree none = Tree::map({{"const", Tree::quote("none")}});
  return Tree::map({{"anyOf", Tree::list({field.group ? name : none, std::move(group)})}});
}

/// Returns a copy of `schema` in which each number may also be a range such as `uniform(3 cm, 8 cm)`.
Tree or_drawn(Tree schema) {
  const Tree* type = schema.find("type");
  if (schema.find("pattern") != nullptr || (type != nullptr && (type->text == "number" || type->text == "integer"))) {
    const Tree drawn =
        Tree::map({{"type", Tree::quote("string")}, {"pattern", Tree::quote("^(log_)?uniform\\(.*\\)$")}});
    return Tree::map({{"anyOf", Tree::list({std::move(schema), drawn})}});
  }
  for (Tree& item : schema.items) item = or_drawn(std::move(item));
  for (Tree::Entry& entry : schema.entries) entry.value = or_drawn(std::move(entry.value));
  return schema;
}

/// Returns the schema of a list of groups, or of a random draw of that list: see scene/random_objects.hpp.
Tree list_schema(const FieldDescription& field) {
  Tree item = group_schema(field.fields);
  Tree list = array_schema(item);
  if (!field.drawable) return list;
  const auto closed = [](Tree properties) {
    Tree required = Tree::list();
    for (const Tree::Entry& entry : properties.entries) required.items.push_back(Tree::quote(entry.key));
    return Tree::map({{"type", Tree::quote("object")},
                      {"properties", std::move(properties)},
                      {"required", std::move(required)},
                      {"additionalProperties", Tree::scalar("false")}});
  };
  const Tree count = Tree::map({{"type", Tree::quote("integer")}});
  const Tree draw =
      closed(Tree::map({{"least", count}, {"most", count}, {"of", array_schema(or_drawn(std::move(item)))}}));
  return Tree::map({{"anyOf", Tree::list({std::move(list), closed(Tree::map({{"draw", draw}}))})}});
}

/// Returns the schema of a field's values.
Tree value_schema(const FieldDescription& field) {
  switch (field.type) {
    case Type::real:
      return number_schema(field.unit);
    case Type::reals:
      return row_schema(field);
    case Type::table:
      return array_schema(row_schema(field));
    case Type::integer:
      return Tree::map({{"type", Tree::quote("integer")}});
    case Type::flag:
      return Tree::map({{"type", Tree::quote("boolean")}});
    case Type::text:
      return Tree::map({{"type", Tree::quote("string")}});
    case Type::choice: {
      Tree names = Tree::list();
      for (const auto& one : field.cases) names.items.push_back(Tree::quote(one.name));
      return Tree::map({{"enum", names}});
    }
    case Type::section:
      return section_schema(field);
    case Type::sections:
      return list_schema(field);
    case Type::plugin:
      if (field.adopted) return Tree::map({{"type", Tree::quote("string")}});
      break;
    case Type::plugins: {
      // An item of a list cannot be the name of a group file, so it must be a map with a type.
      const Tree typed = Tree::map({{"type", Tree::quote("object")}, {"required", Tree::list({Tree::quote("type")})}});
      return array_schema(Tree::map({{"allOf", Tree::list({plugin_schema(field.kind), typed})}}));
    }
  }
  return plugin_schema(field.kind);
}

Tree field_schema(const FieldDescription& field) {
  if (field.type == Type::plugin && !field.adopted) return plugin_schema(field.kind);
  const std::string range = field.range.empty() ? "" : " (" + field.range + ")";
  Tree out = Tree::map({{"description", Tree::quote(field.meaning + range)}});
  for (Tree::Entry& entry : value_schema(field).entries) out.entries.push_back(std::move(entry));
  return out;
}

/// Adds the properties of `fields`, including those of all cases of a choice.
void add_properties(Tree& properties, const std::vector<FieldDescription>& fields) {
  for (const FieldDescription& field : fields) {
    properties.at(field.name) = field_schema(field);
    for (const auto& one : field.cases) add_properties(properties, one.fields);
  }
}

}  // namespace

std::string FieldDescription::type_name() const {
  // Names in the order of FieldDescription::Type.
  constexpr std::array kNames{"{dimension}",
                              "{count} {dimension}s",
                              "rows of {count} {dimension}s",
                              "whole number",
                              "true or false",
                              "text",
                              "one of {cases}",
                              "group",
                              "list of groups",
                              "plugin of kind {kind}",
                              "list of plugins of kind {kind}"};
  std::vector<std::string> names;
  for (const CaseDescription& one : cases) names.push_back(one.name);
  return fmt::format(fmt::runtime(kNames[static_cast<std::size_t>(type)]), fmt::arg("dimension", dimension_name(unit)),
                     fmt::arg("count", count), fmt::arg("cases", fmt::join(names, ", ")), fmt::arg("kind", kind));
}

FieldDescription describe_key(const Field& field) {
  FieldDescription out;
  out.name = field.name;
  out.unit = field.unit;
  out.range = range_text(field);
  out.meaning = field.meaning;
  out.source = field.source;
  out.required = field.required;
  out.group = field.is_group;
  out.drawable = field.is_drawable;
  out.heir_of = field.heir_of;
  out.owner = field.owner;
  out.beside = field.beside;
  out.neutral = constant_text(field.neutral_value, field.unit);
  return out;
}

FieldDescription describe_beside(const FieldDescription& field) {
  FieldDescription out;
  out.name = field.beside;
  out.type = Type::section;
  out.kind = field.kind;
  out.group = true;
  out.meaning = fmt::format("{} of the {}", field.beside, field.name);
  return out;
}

std::vector<FieldDescription> describe_fields(const std::function<void(Fields&)>& list, const PluginCases& plugins) {
  Describer describer(plugins);
  list(describer);
  return std::move(describer.rows);
}

std::string describe_text(const std::vector<FieldDescription>& fields) {
  std::vector<std::vector<std::string>> lines{{"  option", "type and range", "default", "meaning"}};
  append_text(lines, fields, "  ");
  return aligned(lines, "llll");
}

Tree describe_tree(const std::vector<FieldDescription>& fields) {
  Tree list = Tree::list();
  for (const FieldDescription& field : fields) {
    Tree row = Tree::map({{"name", Tree::quote(field.name)},
                          {"type", Tree::quote(field.type_name())},
                          {"unit", Tree::quote(unit_symbol(field.unit))},
                          {"range", Tree::quote(field.range)},
                          {"default", field.required ? Tree{} : Tree::quote(field.default_value)},
                          {"required", Tree::scalar(field.required ? "true" : "false")},
                          {"meaning", Tree::quote(field.meaning)},
                          {"source", Tree::quote(field.source)}});
    for (const auto& one : field.cases) {
      Tree& cases = row.at("cases");
      cases.kind = Tree::Kind::list;
      cases.items.push_back(Tree::map({{"name", Tree::quote(one.name)},
                                       {"meaning", Tree::quote(one.meaning)},
                                       {"options", describe_tree(one.fields)}}));
    }
    if (!field.fields.empty()) row.at("options") = describe_tree(field.fields);
    list.items.push_back(std::move(row));
  }
  return list;
}

Tree schema_of(const std::vector<FieldDescription>& fields) {
  Tree properties = Tree::map();
  add_properties(properties, fields);
  Tree out = Tree::map({{"type", Tree::quote("object")}, {"properties", std::move(properties)}});
  const bool open =
      std::any_of(fields.begin(), fields.end(), [](const FieldDescription& field) { return field.adopted; });
  if (!open) out.at("additionalProperties") = Tree::scalar("false");
  return out;
}

}  // namespace palpate
