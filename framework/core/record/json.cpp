// SPDX-License-Identifier: MIT
#include "record/json.hpp"

#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

// Far beyond what is ever written, and little enough to be held in memory.
constexpr std::size_t kMostValues = 1'000'000;  ///< of a tree
constexpr std::size_t kMostLevels = 100;
constexpr std::size_t kMostRowValues = 4096;
constexpr std::size_t kMostNameBytes = 1024;  ///< of a name in a row, which repeats those of all that is around it
constexpr std::size_t kMostLines = 1'100'000;
constexpr std::size_t kMostLineValues = 20'000'000;  ///< of all lines of a file
constexpr std::size_t kNameOfOneValue = 64;          ///< bytes; a value with a longer name counts more than once

constexpr const char* kNoObject = "is not a JSON object";
constexpr const char* kTooDeep = "is nested too deeply: at most 100 levels";
constexpr const char* kDamaged = "the file is damaged";

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
  bool start_array(std::size_t) override { return !prefixes_.empty() && open_in_list('['); }
  bool end_array() override { return close_in_list(']'); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

  bool start_object(std::size_t) override {
    if (levels_ > 0) return open_in_list('{');
    if (prefixes_.size() == kMostLevels) return refuse(kTooDeep);
    prefixes_.push_back(prefixes_.empty() ? "" : name_ + ".");
    return true;
  }
  bool key(string_t& key) override {
    if (levels_ > 0) {
      separate();
      list_.append(json_quoted(key)).append(": ");
      return true;
    }
    if (prefixes_.back().size() + key.size() > kMostNameBytes) return refuse("has a name of more than 1 KiB");
    name_.assign(prefixes_.back()).append(key);
    return true;
  }
  bool end_object() override {
    if (levels_ > 0) return close_in_list('}');
    prefixes_.pop_back();
    return true;
  }

  const char* reason = kNoObject;  ///< for which it was refused

 private:
  template <class T>
  bool add(T value) {
    if (prefixes_.empty()) return false;
    if (levels_ > 0) {
      separate();
      list_ += json_value(Scalar(std::move(value)));
      return true;
    }
    if (row_.fields.size() == kMostRowValues) return refuse("contains too many values: at most 4096");
    row_.fields.emplace_back(name_, std::move(value));
    return true;
  }
  bool refuse(const char* why) {
    reason = why;
    return false;
  }
  /// A comma, where another item of the list or member of its object stands before.
  void separate() {
    if (!list_.empty() && std::string_view("[{ ").find(list_.back()) == std::string_view::npos) list_ += ", ";
  }
  bool open_in_list(char bracket) {
    if (prefixes_.size() + levels_ == kMostLevels) return refuse(kTooDeep);
    separate();
    list_ += bracket;
    ++levels_;
    return true;
  }
  bool close_in_list(char bracket) {
    list_ += bracket;
    return --levels_ > 0 || add(JsonList{std::exchange(list_, {})});
  }

  Row& row_;
  std::string list_;                   ///< of the list at hand, as far as it was read
  std::size_t levels_ = 0;             ///< open lists and objects within it; 0: none is at hand
  std::string name_;                   ///< of the value to come, dotted
  std::vector<std::string> prefixes_;  ///< of the names in the open objects: "a." in {"a": {...
};

constexpr const char* kDamagedFile = "the file is damaged: put it back as it was, or remove it";

/// Builds a tree from the same events. Throws Error for what is JSON, and yet not read. Scalars that are no strings are
/// kept as they are written.
class TreeReader final : public nlohmann::json_sax<Json> {
 public:
  explicit TreeReader(const std::filesystem::path& file) : file_(file) {}

  Tree tree;
  std::size_t bytes = 0;  ///< read when it was found to be no JSON

  bool null() override { return add({}); }
  bool boolean(bool value) override { return add(Tree::scalar(value ? "true" : "false")); }
  bool number_integer(number_integer_t value) override { return add(Tree::scalar(std::to_string(value))); }
  bool number_unsigned(number_unsigned_t value) override { return add(Tree::scalar(std::to_string(value))); }
  bool number_float(number_float_t, const string_t& text) override { return add(Tree::scalar(text)); }
  bool string(string_t& value) override { return add(Tree::scalar(std::move(value), true)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Tree::map()); }
  bool start_array(std::size_t) override { return open(Tree::list()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& key) override {
    open_.back()->entries.push_back({std::move(key), {}, {}});
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) override {
    bytes = position;
    return false;
  }

 private:
  /// Where the value to come belongs. What is open does not move: only the innermost grows.
  Tree& place() {
    if (open_.empty()) return tree;
    Tree& inner = *open_.back();
    return inner.is_map() ? inner.entries.back().value : inner.items.emplace_back();
  }
  Tree& put(Tree value) {
    const auto refuse = [&](const char* reason) { throw Error(file_.string(), reason, kDamagedFile); };
    if (open_.empty() && !value.is_map()) refuse(kNoObject);
    if (open_.size() > kMostLevels) refuse(kTooDeep);
    if (++values_ > kMostValues) refuse("contains too many values");
    return place() = std::move(value);
  }
  bool add(Tree value) {
    put(std::move(value));
    return true;
  }
  bool open(Tree empty) {
    open_.push_back(&put(std::move(empty)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const std::filesystem::path& file_;
  std::vector<Tree*> open_;
  std::size_t values_ = 0;
};

/// `indent`: what a line of it begins with; "" for one line alone.
void append(std::string& out, const Tree& tree, const std::string& indent) {
  const std::string inner = indent.empty() ? "" : indent + "  ";
  switch (tree.kind) {
    case Tree::Kind::null:
      out += "null";
      break;
    case Tree::Kind::scalar:
      out += tree.quoted ? json_quoted(tree.text) : tree.text;
      break;
    case Tree::Kind::list:
    case Tree::Kind::map: {
      const char* separator = "";
      out += tree.is_map() ? "{" : "[";
      const auto add = [&](const std::string& name, const Tree& value) {
        out += std::exchange(separator, indent.empty() ? ", " : ",") + inner + name;
        append(out, value, inner);
      };
      for (const Tree& item : tree.items) add("", item);
      for (const Tree::Entry& entry : tree.entries) add(json_quoted(entry.key) + ": ", entry.value);
      if (!tree.items.empty() || !tree.entries.empty()) out += indent;
      out += tree.is_map() ? "}" : "]";
      break;
    }
  }
}

}  // namespace

std::optional<Row> parse_json_row(const std::string& text, std::string* reason) {
  Row row;
  RowReader reader(row);
  if (Json::sax_parse(text, &reader)) return row;
  if (reason != nullptr) *reason = reader.reason;
  return std::nullopt;
}

std::string RowLines::place() const { return fmt::format("{}:{}", file_.string(), number_); }

Row RowLines::read(const std::string& line) {
  ++number_;
  std::string reason = "is too long: a line has at most 1 MiB";
  std::optional<Row> row;
  if (line.size() <= kMostLineBytes) row = parse_json_row(line, &reason);
  if (!row) throw Error(place(), reason, kDamaged);
  // Names that repeat all that is around them would fill the memory where there are many.
  for (const auto& field : row->fields) values_ += 1 + field.first.size() / kNameOfOneValue;
  if (number_ > kMostLines || values_ > kMostLineValues)
    throw Error(place(), "the file is too large: at most 1.1 million lines and 20 million values", kDamaged);
  return std::move(*row);
}

std::vector<Row> rows_of(const JsonList& list) {
  const Json parsed = Json::parse(list.text, nullptr, false);
  std::vector<Row> out;
  for (const Json& one : parsed.is_array() ? parsed : Json::array()) {
    if (const std::optional<Row> row = parse_json_row(one.dump())) out.push_back(*row);
  }
  return out;
}

JsonLines read_json_lines(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  JsonLines out;
  RowLines lines(file);
  for (std::size_t end; (end = text.find('\n', out.bytes)) != std::string::npos; out.bytes = end + 1)
    out.rows.push_back(lines.read(text.substr(out.bytes, end - out.bytes)));
  return out;
}

Tree read_json(const std::filesystem::path& file, Origin origin) {
  const std::optional<std::string> text = read_if_there(file, kMostManifestBytes, origin);
  if (!text) throw Error(file.string(), "cannot be read");
  return parse_json(*text, 0, text->size(), file);
}

Tree parse_json(const std::string& text, std::size_t begin, std::size_t end, const std::filesystem::path& file) {
  TreeReader reader(file);
  if (Json::sax_parse(text.data() + begin, text.data() + end, &reader)) return std::move(reader.tree);
  throw Error(place_in(file.string(), text, begin + std::max<std::size_t>(reader.bytes, 1) - 1), "is not valid JSON",
              kDamagedFile);
}

std::string to_json(const Tree& tree) {
  std::string out;
  append(out, tree, "\n");
  return out + "\n";
}

std::string to_json_line(const Tree& tree) {
  std::string out;
  append(out, tree, "");
  return out;
}

bool is_json(const std::string& text) { return Json::accept(text); }

}  // namespace palpate
