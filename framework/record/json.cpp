// SPDX-License-Identifier: MIT
#include "record/json.hpp"

#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

// These limits are far above the size of files that palpate writes, and small enough for the memory.
constexpr std::size_t kMostValues = 1'000'000;  ///< values of a tree
constexpr std::size_t kMostLevels = 100;
constexpr std::size_t kMostRowValues = 4096;
constexpr std::size_t kMostListedValues = 100'000;  ///< values of a row, including those in its lists
constexpr std::size_t kMostNameBytes =
    1024;  ///< bytes of a joined name, which contains the names of all enclosing objects
constexpr std::size_t kMostLines = 1'100'000;
constexpr std::size_t kMostLineValues = 20'000'000;  ///< values of all lines of a file
constexpr std::size_t kNameOfOneValue = 64;          ///< bytes; a value with a longer name counts as several values

constexpr const char* kNoObject = "is not a JSON object";
constexpr const char* kTooDeep = "is nested too deeply: at most 100 levels";
constexpr const char* kDamaged = "the file is damaged";

constexpr const char* kDamagedFile = "the file is damaged: put it back as it was, or remove it";

/// Builds a tree from the events of the JSON parser, and stops the parser at the first value that it rejects. Scalars
/// other than strings are kept as written.
class TreeReader final : public nlohmann::json_sax<Json> {
 public:
  Tree tree;
  std::size_t most = kMostValues;
  const char* reason = nullptr;  ///< reason of the rejection
  std::size_t bytes = 0;         ///< bytes read before a syntax error; 0 without one

  /// Parses `text`; returns whether it is one JSON object.
  bool read(const std::string& text) {
    const bool valid = Json::sax_parse(text, this);
    if (reason == nullptr && !tree.is_map()) reason = kNoObject;
    return valid && reason == nullptr;
  }

  bool null() override { return put({}) != nullptr; }
  bool boolean(bool value) override { return put(Tree::scalar(value ? "true" : "false")) != nullptr; }
  bool number_integer(number_integer_t value) override { return put(Tree::scalar(std::to_string(value))) != nullptr; }
  bool number_unsigned(number_unsigned_t value) override { return put(Tree::scalar(std::to_string(value))) != nullptr; }
  bool number_float(number_float_t, const string_t& text) override {
    std::string own = text;  // its decimal point may be that of the locale
    for (char& c : own) c = std::string_view("+-0123456789eE").find(c) == std::string_view::npos ? '.' : c;
    return put(Tree::scalar(std::move(own))) != nullptr;
  }
  bool string(string_t& value) override { return put(Tree::quote(std::move(value))) != nullptr; }
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
    bytes = std::max<std::size_t>(position, 1);
    reason = kNoObject;
    return false;
  }

 private:
  /// Returns the tree in which the next value is stored. Pointers to open lists and maps stay valid, because only the
  /// innermost list or map grows.
  Tree& place() {
    if (open_.empty()) return tree;
    Tree& inner = *open_.back();
    return inner.is_map() ? inner.entries.back().value : inner.items.emplace_back();
  }
  Tree* put(Tree value) {
    if (open_.size() > kMostLevels) reason = kTooDeep;
    if (++values_ > most) reason = "contains too many values";
    if (reason != nullptr) return nullptr;
    return &(place() = std::move(value));
  }
  bool open(Tree empty) {
    open_.push_back(put(std::move(empty)));
    return open_.back() != nullptr;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::vector<Tree*> open_;
  std::size_t values_ = 0;
};

/// Returns a scalar or a list as the value of a row.
Scalar scalar_of(const Tree& value) {
  if (value.kind == Tree::Kind::null) return {};
  if (value.kind == Tree::Kind::list) return JsonList{to_json_line(value)};
  const std::string& text = value.text;
  if (value.quoted) return text;
  if (text == "true" || text == "false") return text == "true";
  const auto read = [&](auto number) {
    const auto [end, trouble] = std::from_chars(text.data(), text.data() + text.size(), number);
    return trouble == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
  };
  if (const auto integer = read(std::int64_t{0})) return *integer;
  return read(0.0).value_or(0.0);
}

/// Adds the values of a map and of its nested maps to a row. If a limit is exceeded, returns the reason as text; else
/// null.
const char* add_fields(Row& row, const Tree& map, const std::string& prefix) {
  for (const Tree::Entry& entry : map.entries) {
    const std::string name = prefix + entry.key;
    if (name.size() > kMostNameBytes) return "has a name of more than 1 KiB";
    if (entry.value.is_map()) {
      if (const char* const reason = add_fields(row, entry.value, name + ".")) return reason;
      continue;
    }
    if (row.fields.size() == kMostRowValues) return "contains too many values: at most 4096";
    row.add(name, scalar_of(entry.value));
  }
  return nullptr;
}

void append_quoted(std::string& out, std::string_view text) {
  const auto is_plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  // Fast path for texts without characters to escape: in these texts, the JSON library's search for such characters
  // would take a tenth of the time of a run.
  if (std::all_of(text.begin(), text.end(), is_plain)) {
    out += '"';
    out += text;
    out += '"';
  } else {
    out += Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
  }
}

/// Writes the separator and the indentation before each value of a list or map.
class JsonSeparator {
 public:
  /// `indent`: line break and indentation of the list itself; "" to write all values in one line.
  explicit JsonSeparator(const std::string& indent) : indent_(indent.empty() ? "" : indent + "  ") {}
  void operator()(std::string& out) {
    out += separator_;
    out += indent_;
    separator_ = indent_.empty() ? ", " : ",";
  }
  bool came() const { return !separator_.empty(); }
  const std::string& indent() const { return indent_; }

 private:
  std::string_view separator_;
  std::string indent_;
};

void append(std::string& out, const Tree& tree, const std::string& indent) {
  if (tree.kind == Tree::Kind::null) out += "null";
  if (tree.is_scalar()) tree.quoted ? append_quoted(out, tree.text) : void(out += tree.text);
  if (tree.kind == Tree::Kind::null || tree.is_scalar()) return;
  JsonSeparator next(indent);
  out += tree.is_map() ? "{" : "[";
  for (const Tree& item : tree.items) {
    next(out);
    append(out, item, next.indent());
  }
  for (const Tree::Entry& entry : tree.entries) {
    next(out);
    append_quoted(out, entry.key);
    append(out += ": ", entry.value, next.indent());
  }
  if (next.came()) out += indent;
  out += tree.is_map() ? "}" : "]";
}

void append(std::string& out, const Scalar& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return append_quoted(out, *text);
  const auto* list = std::get_if<JsonList>(&value);
  const std::string text = list != nullptr ? list->text : csv_cell(value);
  out += text.empty() ? "null" : text;
}

/// Appends a map of the consecutive fields from index `field` on whose names begin with `prefix`. Sets `field` to the
/// index after the last of these fields.
void append(std::string& out, const Row& row, std::size_t& field, std::string_view prefix, const std::string& indent) {
  JsonSeparator next(indent);
  out += "{";
  while (field < row.fields.size()) {
    const std::string_view name = row.fields[field].first;
    if (name.substr(0, prefix.size()) != prefix) break;
    const std::size_t dot = name.find('.', prefix.size());
    next(out);
    append_quoted(out, name.substr(prefix.size(), dot - prefix.size()));
    out += ": ";
    if (dot == std::string_view::npos) {
      append(out, row.fields[field++].second);
    } else {
      append(out, row, field, name.substr(0, dot + 1), next.indent());
    }
  }
  if (next.came()) out += indent;
  out += "}";
}

}  // namespace

std::optional<Row> parse_json_row(const std::string& text, std::string* reason) {
  TreeReader reader;
  reader.most = kMostListedValues;
  Row row;
  const char* refused = reader.read(text) ? add_fields(row, reader.tree, "") : reader.reason;
  if (refused == nullptr) return row;
  if (reason != nullptr) *reason = refused;
  return std::nullopt;
}

std::string JsonLinesReader::place() const { return fmt::format("{}:{}", file_.string(), number_); }

Row JsonLinesReader::read(const std::string& line) {
  ++number_;
  std::string reason = "is too long: a line has at most 1 MiB";
  std::optional<Row> row;
  if (line.size() <= kMostLineBytes) row = parse_json_row(line, &reason);
  if (!row) throw Error(place(), reason, kDamaged);
  // Long joined names count as several values, because many of them would fill the memory.
  for (const auto& field : row->fields) values_ += 1 + field.first.size() / kNameOfOneValue;
  if (number_ > kMostLines || values_ > kMostLineValues)
    throw Error(place(), "the file is too large: at most 1.1 million lines and 20 million values", kDamaged);
  return std::move(*row);
}

std::vector<Row> rows_of(const Tree& list) {
  std::vector<Row> out;
  for (const Tree& item : list.items) {
    Row row;
    if (item.is_map() && add_fields(row, item, "") == nullptr) out.push_back(std::move(row));
  }
  return out;
}

std::vector<Row> rows_of(const JsonList& list) {
  TreeReader reader;
  return Json::sax_parse(list.text, &reader) ? rows_of(reader.tree) : std::vector<Row>();
}

JsonList list_of(const std::vector<Row>& rows) {
  std::string out = "[";
  for (const Row& row : rows) out.append(out.size() > 1 ? ", " : "").append(to_json_line(row));
  return {out + "]"};
}

std::uintmax_t read_json_lines(const std::filesystem::path& file, const std::function<void(Row)>& use) {
  const std::string text = read_file(file);
  JsonLinesReader lines(file);
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
    use(lines.read(text.substr(begin, end - begin)));
  return begin;
}

Tree read_json(const std::filesystem::path& file, FileOrigin origin) {
  const std::optional<std::string> text = read_if_there(file, kMostManifestBytes, origin);
  if (!text) throw Error(file.string(), "cannot be read");
  return parse_json(*text, file);
}

Tree parse_json(const std::string& text, const std::filesystem::path& file) {
  TreeReader reader;
  if (reader.read(text)) return std::move(reader.tree);
  if (reader.bytes == 0) throw Error(file.string(), reader.reason, kDamagedFile);
  throw Error(place_in(file.string(), text, reader.bytes - 1), "is not valid JSON", kDamagedFile);
}

std::string to_json(const Row& row) {
  std::string out;
  std::size_t field = 0;
  append(out, row, field, "", "\n");
  return out + "\n";
}

std::string to_json_line(const Row& row) {
  std::string out;
  std::size_t field = 0;
  append(out, row, field, "", "");
  return out;
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

}  // namespace palpate
