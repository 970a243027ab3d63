// SPDX-License-Identifier: MIT
#include "config/describe.hpp"

#include "config/quantity.hpp"

#include <fmt/format.h>

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
    for (std::size_t i = 0; i < count; ++i) {
      row.default_value += (i == 0 ? "[" : ", ") + write_quantity(values[i], field.unit);
    }
    row.default_value += "]";
  }
  void table(std::vector<double>& values, std::size_t columns, const Field& field) override {
    FieldDescription& row = add(Type::table, field);
    row.count = columns;
    row.default_value = "[";
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % columns == 0) row.default_value += i == 0 ? "[" : ", [";
      row.default_value += write_quantity(values[i], field.unit) + (i % columns + 1 == columns ? "]" : ", ");
    }
    row.default_value += "]";
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
    std::vector<FieldDescription::CaseDescription> described;
    for (const Case& one : cases) {
      described.push_back(
          {one.name, one.meaning, one.list ? describe_fields(one.list, plugins_) : std::vector<FieldDescription>{}});
    }
    row.cases = std::move(described);
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

Tree quoted(const std::string& text) { return Tree::scalar(text, true); }

/// A quantity in a config is a text such as "1.7 cm"; the pattern lets an editor say so while one types.
std::string quantity_pattern(Unit unit) {
  std::string units;
  for (const std::string& name : unit_names(unit)) units += (units.empty() ? "" : "|") + name;
  return fmt::format("^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)? *({})$", units);
}

void number_schema(Tree& out, const FieldDescription& field) {
  if (field.unit == Unit::none) {
    out.at("type") = quoted("number");
  } else {
    out.at("type") = quoted("string");
    out.at("pattern") = quoted(quantity_pattern(field.unit));
  }
}

/// As many numbers as `field` has in a row.
void row_schema(Tree& out, const FieldDescription& field) {
  out.at("type") = quoted("array");
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
    if (!typed->required) continue;
    any.items.back().at("required") = Tree::list();
    any.items.back().at("required").items.push_back(quoted(typed->name));
  }
  return out;
}

Tree field_schema(const FieldDescription& field) {
  Tree out = Tree::map();
  const std::string range = field.range.empty() ? "" : " (" + field.range + ")";
  out.at("description") = quoted(field.meaning + range);
  switch (field.type) {
    case Type::real:
      number_schema(out, field);
      break;
    case Type::reals:
      row_schema(out, field);
      break;
    case Type::table:
      out.at("type") = quoted("array");
      row_schema(out.at("items"), field);
      break;
    case Type::integer:
      out.at("type") = quoted("integer");
      break;
    case Type::flag:
      out.at("type") = quoted("boolean");
      break;
    case Type::text:
      out.at("type") = quoted("string");
      break;
    case Type::choice: {
      Tree names = Tree::list();
      for (const auto& one : field.cases) names.items.push_back(quoted(one.name));
      out.at("enum") = names;
      break;
    }
    case Type::section: {
      Tree inner = group_schema(field.fields);
      if (field.optional || field.group) {
        Tree word = Tree::map();
        if (field.group) {
          word.at("type") = quoted("string");
          word.at("description") = quoted(fmt::format("a name: NAME reads {}/NAME.yaml", field.name));
        } else {
          word.at("const") = quoted("none");
        }
        Tree either = Tree::list();
        either.items = {std::move(word), std::move(inner)};
        out.at("anyOf") = std::move(either);
        break;
      }
      for (const Tree::Entry& entry : inner.entries) out.entries.push_back(entry);
      break;
    }
    case Type::sections: {
      out.at("type") = quoted("array");
      out.at("items") = group_schema(field.fields);
      break;
    }
    case Type::plugin:
      out = Tree::map();
      out.at("$ref") = quoted("#/definitions/" + field.kind);
      break;
    case Type::plugins: {
      // In a list no group is chosen by its name: every item is a map with a type.
      Tree plugin = Tree::map();
      plugin.at("$ref") = quoted("#/definitions/" + field.kind);
      Tree typed = Tree::map();
      typed.at("type") = quoted("object");
      typed.at("required") = Tree::list();
      typed.at("required").items.push_back(quoted("type"));
      Tree both = Tree::list();
      both.items = {std::move(plugin), std::move(typed)};
      out.at("type") = quoted("array");
      out.at("items").at("allOf") = std::move(both);
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
  switch (type) {
    case Type::real:
      return dimension_name(unit);
    case Type::reals:
      return fmt::format("{} {}s", count, dimension_name(unit));
    case Type::table:
      return fmt::format("rows of {} {}s", count, dimension_name(unit));
    case Type::integer:
      return "whole number";
    case Type::flag:
      return "true or false";
    case Type::text:
      return "text";
    case Type::choice: {
      std::string names = "one of";
      for (std::size_t i = 0; i < cases.size(); ++i) names += (i == 0 ? " " : ", ") + cases[i].name;
      return names;
    }
    case Type::section:
      return "group";
    case Type::sections:
      return "list of groups";
    case Type::plugin:
      return "plugin of kind " + kind;
    case Type::plugins:
      return "list of plugins of kind " + kind;
  }
  return {};
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
    row.at("name") = quoted(field.name);
    row.at("type") = quoted(field.type_name());
    row.at("unit") = quoted(unit_symbol(field.unit));
    row.at("range") = quoted(field.range);
    row.at("default") = field.required ? Tree{} : quoted(field.default_value);
    row.at("required") = Tree::scalar(field.required ? "true" : "false");
    row.at("meaning") = quoted(field.meaning);
    row.at("source") = quoted(field.source);
    if (!field.cases.empty()) {
      Tree cases = Tree::list();
      for (const auto& one : field.cases) {
        Tree entry = Tree::map();
        entry.at("name") = quoted(one.name);
        entry.at("meaning") = quoted(one.meaning);
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
  out.at("type") = quoted("object");
  Tree properties = Tree::map();
  add_properties(properties, fields);
  out.at("properties") = std::move(properties);
  out.at("additionalProperties") = Tree::scalar("false");
  return out;
}

}  // namespace palpate
