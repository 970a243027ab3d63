// SPDX-License-Identifier: MIT
#include "config/describe.hpp"

#include "config/expand.hpp"
#include "config/quantity.hpp"

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
  explicit Describer(const PluginCases& plugins) : plugins_(plugins) {}

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

void append_text(std::vector<std::array<std::string, 4>>& lines, const std::vector<FieldDescription>& fields,
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

/// A quantity in a config is a text such as "1.7 cm"; the pattern lets an editor say so while one types.
std::string quantity_pattern(Unit unit) {
  return fmt::format("^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)? *({})$", fmt::join(unit_names(unit), "|"));
}

void number_schema(Tree& out, const FieldDescription& field) {
  if (field.unit == Unit::none) {
    out.at("type") = Tree::quote("number");
  } else {
    out.at("type") = Tree::quote("string");
    out.at("pattern") = Tree::quote(quantity_pattern(field.unit));
  }
}

/// As many numbers as `field` has in a row.
void row_schema(Tree& out, const FieldDescription& field) {
  out.at("type") = Tree::quote("array");
  number_schema(out.at("items"), field);
  out.at("minItems") = Tree::scalar(std::to_string(field.count));
  out.at("maxItems") = Tree::scalar(std::to_string(field.count));
}

/// A group with a type has a schema for each of its cases, with the fields of that and of no other.
Tree group_schema(const std::vector<FieldDescription>& fields) {
  const auto typed = std::find_if(fields.begin(), fields.end(), [](const FieldDescription& field) {
    return std::any_of(field.cases.begin(), field.cases.end(), [](const auto& one) { return !one.fields.empty(); });
  });
  if (typed == fields.end()) return schema_of(fields);
  Tree out = Tree::map();
  Tree& any = out.at("anyOf");
  any = Tree::list();
  std::vector<FieldDescription> chosen = fields;
  for (const auto& one : typed->cases) {
    chosen[static_cast<std::size_t>(typed - fields.begin())].cases = {one};
    any.items.push_back(schema_of(chosen));
    if (typed->required) any.items.back().at("required") = Tree::list({Tree::quote(typed->name)});
  }
  return out;
}

Tree field_schema(const FieldDescription& field) {
  Tree out = Tree::map();
  const std::string range = field.range.empty() ? "" : " (" + field.range + ")";
  out.at("description") = Tree::quote(field.meaning + range);
  switch (field.type) {
    case Type::real:
      number_schema(out, field);
      break;
    case Type::reals:
      row_schema(out, field);
      break;
    case Type::table:
      out.at("type") = Tree::quote("array");
      row_schema(out.at("items"), field);
      break;
    case Type::integer:
    case Type::flag:
    case Type::text:
      out.at("type") = Tree::quote(field.type == Type::integer ? "integer"
                                   : field.type == Type::flag  ? "boolean"
                                                               : "string");
      break;
    case Type::choice: {
      Tree& names = out.at("enum") = Tree::list();
      for (const auto& one : field.cases) names.items.push_back(Tree::quote(one.name));
      break;
    }
    case Type::section: {
      Tree inner = group_schema(field.fields);
      if (field.optional || field.group) {
        Tree word = Tree::map();
        if (field.group) {
          word.at("type") = Tree::quote("string");
          word.at("description") = Tree::quote(fmt::format("a name: NAME reads {}/NAME.yaml", field.name));
        } else {
          word.at("const") = Tree::quote("none");
        }
        out.at("anyOf") = Tree::list({std::move(word), std::move(inner)});
        break;
      }
      for (const Tree::Entry& entry : inner.entries) out.entries.push_back(entry);
      break;
    }
    case Type::sections:
      out.at("type") = Tree::quote("array");
      out.at("items") = group_schema(field.fields);
      break;
    case Type::plugin:
      out = Tree::map();
      out.at("$ref") = Tree::quote("#/definitions/" + field.kind);
      break;
    case Type::plugins: {
      // In a list no group is chosen by its name: every item is a map with a type.
      Tree plugin = Tree::map();
      plugin.at("$ref") = Tree::quote("#/definitions/" + field.kind);
      Tree typed = Tree::map();
      typed.at("type") = Tree::quote("object");
      typed.at("required") = Tree::list({Tree::quote("type")});
      out.at("type") = Tree::quote("array");
      out.at("items").at("allOf") = Tree::list({std::move(plugin), std::move(typed)});
      break;
    }
  }
  return out;
}

/// Adds the properties of `fields`, those of the cases of a choice included.
void add_properties(Tree& properties, const std::vector<FieldDescription>& fields) {
  for (const FieldDescription& field : fields) {
    properties.at(field.name) = field_schema(field);
    for (const auto& one : field.cases) add_properties(properties, one.fields);
  }
}

}  // namespace

std::string FieldDescription::type_name() const {
  // In the order of Type.
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
  out.heir_of = field.heir_of;
  out.owner = field.owner;
  return out;
}

std::vector<FieldDescription> describe_fields(const std::function<void(Fields&)>& list, const PluginCases& plugins) {
  Describer describer(plugins);
  list(describer);
  return std::move(describer.rows);
}

std::string describe_text(const std::vector<FieldDescription>& fields) {
  std::vector<std::array<std::string, 4>> lines{{"option", "type and range", "default", "meaning"}};
  append_text(lines, fields, "");
  std::array<std::size_t, 4> width{};
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < width.size(); ++i) width[i] = std::max(width[i], line[i].size());
  }
  std::string out;
  for (const auto& line : lines) {
    out +=
        fmt::format("  {:<{}}  {:<{}}  {:<{}}  {}\n", line[0], width[0], line[1], width[1], line[2], width[2], line[3]);
  }
  return out;
}

Tree describe_tree(const std::vector<FieldDescription>& fields) {
  Tree list = Tree::list();
  for (const FieldDescription& field : fields) {
    Tree row = Tree::map();
    row.at("name") = Tree::quote(field.name);
    row.at("type") = Tree::quote(field.type_name());
    row.at("unit") = Tree::quote(unit_symbol(field.unit));
    row.at("range") = Tree::quote(field.range);
    row.at("default") = field.required ? Tree{} : Tree::quote(field.default_value);
    row.at("required") = Tree::scalar(field.required ? "true" : "false");
    row.at("meaning") = Tree::quote(field.meaning);
    row.at("source") = Tree::quote(field.source);
    if (!field.cases.empty()) {
      Tree cases = Tree::list();
      for (const auto& one : field.cases) {
        Tree entry = Tree::map();
        entry.at("name") = Tree::quote(one.name);
        entry.at("meaning") = Tree::quote(one.meaning);
        entry.at("options") = describe_tree(one.fields);
        cases.items.push_back(std::move(entry));
      }
      row.at("cases") = std::move(cases);
    }
    if (!field.fields.empty()) row.at("options") = describe_tree(field.fields);
    list.items.push_back(std::move(row));
  }
  return list;
}

Tree schema_of(const std::vector<FieldDescription>& fields) {
  Tree out = Tree::map();
  out.at("type") = Tree::quote("object");
  Tree properties = Tree::map();
  add_properties(properties, fields);
  out.at("properties") = std::move(properties);
  out.at("additionalProperties") = Tree::scalar("false");
  return out;
}

}  // namespace palpate
