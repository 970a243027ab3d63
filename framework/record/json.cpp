// SPDX-License-Identifier: MIT
#include "record/json.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

bool flatten(const Json& json, const std::string& prefix, Row& row) {
  for (const auto& [key, value] : json.items()) {
    const std::string name = prefix + key;
    if (value.is_object()) {
      if (!flatten(value, name + ".", row)) return false;
    } else if (value.is_string()) {
      row.add(name, value.get<std::string>());
    } else if (value.is_boolean()) {
      row.add(name, value.get<bool>());
    } else if (value.is_number_integer()) {
      row.add(name, value.get<std::int64_t>());
    } else if (value.is_number()) {
      row.add(name, value.get<double>());
    } else if (value.is_null()) {
      row.fields.emplace_back(name, std::monostate{});
    } else {
      return false;
    }
  }
  return true;
}

void append(std::string& out, const Tree& tree, const std::string& indent) {
  const std::string inner = indent + "  ";
  switch (tree.kind) {
    case Tree::Kind::null:
      out += "null";
      break;
    case Tree::Kind::scalar:
      out += tree.quoted ? json_quoted(tree.text) : tree.text;
      break;
    case Tree::Kind::list:
      out += "[";
      for (std::size_t i = 0; i < tree.items.size(); ++i) {
        out += (i == 0 ? "\n" : ",\n") + inner;
        append(out, tree.items[i], inner);
      }
      out += tree.items.empty() ? "]" : "\n" + indent + "]";
      break;
    case Tree::Kind::map:
      out += "{";
      for (std::size_t i = 0; i < tree.entries.size(); ++i) {
        out += (i == 0 ? "\n" : ",\n") + inner + json_quoted(tree.entries[i].key) + ": ";
        append(out, tree.entries[i].value, inner);
      }
      out += tree.entries.empty() ? "}" : "\n" + indent + "}";
      break;
  }
}

}  // namespace

std::optional<Row> parse_json_row(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  Row row;
  if (!json.is_object() || !flatten(json, "", row)) return std::nullopt;
  return row;
}

JsonLines read_json_lines(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(file.string(), "cannot be read");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  JsonLines out;
  int line = 0;
  for (std::size_t begin = 0;;) {
    const auto end = text.find('\n', begin);
    if (end == std::string::npos) break;
    ++line;
    std::optional<Row> row = parse_json_row(text.substr(begin, end - begin));
    if (!row) throw Error(fmt::format("{}:{}", file.string(), line), "is not a JSON object", "the file is damaged");
    out.rows.push_back(std::move(*row));
    begin = end + 1;
    out.bytes = begin;
  }
  return out;
}

std::string to_json(const Tree& tree) {
  std::string out;
  append(out, tree, "");
  return out + "\n";
}

bool is_json(const std::string& text) { return Json::accept(text); }

}  // namespace palpate
