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

/// Takes the events of the parser as they come: a tree of all values would cost more than the reading itself. Returns
/// false for what is no row, which ends the parsing.
class RowReader final : public nlohmann::json_sax<Json> {
 public:
  explicit RowReader(Row& row) : row_(row) {}

  bool null() override { return add(std::monostate{}); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(std::int64_t{value}); }
  bool number_unsigned(number_unsigned_t value) override { return add(static_cast<std::int64_t>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_array(std::size_t) override { return false; }
  bool end_array() override { return false; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

  bool start_object(std::size_t) override {
    ends_.push_back(name_.size());
    if (ends_.size() > 1) name_ += '.';
    return true;
  }
  bool key(string_t& key) override {
    name_.resize(prefix());
    name_ += key;
    return true;
  }
  bool end_object() override {
    name_.resize(ends_.back());
    ends_.pop_back();
    return true;
  }

 private:
  /// The length of what comes before the names in the innermost object: "a." in {"a": {...
  std::size_t prefix() const { return ends_.back() + (ends_.size() > 1 ? 1 : 0); }

  template <class T>
  bool add(T value) {
    if (ends_.empty()) return false;
    row_.fields.emplace_back(name_, std::move(value));
    return true;
  }

  Row& row_;
  std::string name_;               ///< of the value to come, dotted
  std::vector<std::size_t> ends_;  ///< lengths of the names of the open objects
};

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
  Row row;
  RowReader reader(row);
  if (!Json::sax_parse(text, &reader)) return std::nullopt;
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
