// SPDX-License-Identifier: MIT
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

namespace palpate {
namespace {

/// Limit of the number of values after the expansion of aliases. Nine lines of aliases, for example, can expand to 10^9
/// values.
constexpr int kMaxValues = 100'000;
constexpr std::size_t kMaxDepth = 100;
/// Limit of the total size of all texts after the expansion of aliases. Configs that palpate writes have at most a
/// quarter of this size.
constexpr std::size_t kMaxTextBytes = 4 << 20;
/// Limit of the number of keys per map, because the time to find a key is linear in this number.
constexpr std::size_t kMaxKeys = 1000;

/// Returns whether the quoted scalar at the beginning of `text` has a closing quote. Without the closing quote,
/// yaml-cpp would read the rest of a config as a part of the scalar.
bool is_closed(std::string_view text) {
  const char quote = text.front();
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 == text.size() || text[i + 1] != quote) return true;
      ++i;  // a doubled quote is an escaped quote
    }
  }
  return false;
}

/// Thrown if the text contains a second document.
class SecondDocument : public YAML::Exception {
 public:
  explicit SecondDocument(const YAML::Mark& at) : Exception(at, "a second document begins here") {}
};

/// Builds the tree of a text from the events of the parser.
class YamlReader final : public YAML::EventHandler {
 public:
  /// `lines`: whether source locations have line numbers. Line numbers are meaningless for an argument of the command
  /// line.
  YamlReader(const std::string& file, bool lines) : file_(std::make_shared<const std::string>(file)), lines_(lines) {
    tree_.place.file = file_;
  }

  /// Returns the tree of the only document; null for an empty document. Throws YAML::Exception if the text is not valid
  /// YAML. Throws Error for the first part that is valid YAML but is rejected.
  Tree read(const std::string& text) {
    // yaml-cpp's positions do not count the byte order mark.
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    text_ = std::string_view(text).substr(text.rfind(kByteOrderMark, 0) == 0 ? kByteOrderMark.size() : 0);
    std::istringstream in(text);
    YAML::Parser parser(in);
    // At most two documents are read, because after a stray comma, yaml-cpp returns endlessly many documents without
    // progress.
    for (; documents_ < 2; ++documents_) parser.HandleNextDocument(*this);
    if (refused_) throw *refused_;
    return std::move(tree_);
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { put(mark, "", anchor, Tree()); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (refused_) return;  // after an error, aliases are skipped, because they may expand to many values
    const auto found = anchors_.find(anchor);  // an alias within its own anchor is not in anchors_
    if (found == anchors_.end()) refuse(place(mark), "nested too deeply", "at most 100 levels");
    put(mark, "", YAML::NullAnchor, found == anchors_.end() ? Tree() : found->second);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    put(mark, tag, anchor, Tree::scalar(value, tag == "!"));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({put(mark, tag, YAML::NullAnchor, Tree::list()), anchor, false});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({put(mark, tag, YAML::NullAnchor, Tree::map()), anchor, false});
  }
  void OnMapEnd() override { close(); }

 private:
  /// A list or map that receives the next values. Its address is stable, because only the innermost open list or map
  /// grows.
  struct OpenContainer {
    Tree* tree;  ///< null after an error
    YAML::anchor_t anchor;
    bool has_key;  ///< whether the tree is a map and the next value belongs to its last key
  };

  void close() {
    if (open_.back().anchor != YAML::NullAnchor && !refused_) anchors_[open_.back().anchor] = *open_.back().tree;
    open_.pop_back();
  }

  /// Adds a key or a value. Returns a pointer to the value in the tree; null for a key. The content of an alias keeps
  /// the source location of its anchor.
  Tree* put(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Tree value) {
    if (documents_ > 0) throw SecondDocument(mark);
    if (refused_) return nullptr;
    if (!value.place.file) value.place = place(mark);
    if (value.quoted) check_quote(mark);
    if (anchor != YAML::NullAnchor) anchors_[anchor] = value;
    Tree* slot = &tree_;
    if (!open_.empty()) {
      Tree& around = *open_.back().tree;
      bool& has_key = open_.back().has_key;
      if (around.is_map() && !std::exchange(has_key, !has_key)) return add_key(around, value);
      slot = around.is_map() ? &around.entries.back().value : &around.items.emplace_back();
      // yaml-cpp may report an absent value (`key:`) on a later line, so the value gets the source location of the key.
      if (around.is_map() && value.kind == Tree::Kind::null) value.place = around.entries.back().place;
    }
    // yaml-cpp sets the tag "?" for plain scalars, and "!" for quoted scalars and block scalars. All other tags are
    // from the text.
    if (!tag.empty() && tag != "?" && tag != "!")
      refuse(value.place, fmt::format("tags ('{}') are not supported", tag), "remove it");
    count(value, open_.size());
    *slot = std::move(value);
    return slot;
  }

  Tree* add_key(Tree& map, const Tree& key) {
    if (!key.is_scalar()) refuse(key.place, "a key must be plain text");
    if (map.entries.size() == kMaxKeys) refuse(key.place, "too many keys", "a map has at most 1000");
    if (key.text == "<<")
      refuse(key.place, "merge keys ('<<') are not supported",
             "repeat the options, or put them into a group file and name it under 'defaults'");
    for (const Tree::Entry& twin : map.entries) {
      if (twin.key != key.text) continue;
      refuse(key.place, fmt::format("duplicate key '{}'", key.text),
             twin.place.line == 0
                 ? "write it once"
                 : fmt::format("it is already at line {}, column {}", twin.place.line, twin.place.column));
    }
    map.entries.push_back({key.text, key.place, {}});
    return nullptr;
  }

  /// Counts a value at nesting depth `depth`, and all values within it, because an alias inserts a value with its
  /// nested values.
  void count(const Tree& value, std::size_t depth) {
    if (++values_ > kMaxValues)
      refuse(value.place, "too many values", "use fewer aliases: they expand to more than 100000 values");
    if (depth > kMaxDepth) refuse(value.place, "nested too deeply", "at most 100 levels");
    text_bytes_ += value.text.size();
    for (const Tree::Entry& entry : value.entries) text_bytes_ += entry.key.size();
    if (text_bytes_ > kMaxTextBytes)
      refuse(value.place, "too much text", "use fewer aliases: they expand to more than 4 MiB");
    if (refused_) return;
    for (const Tree& item : value.items) count(item, depth + 1);
    for (const Tree::Entry& entry : value.entries) count(entry.value, depth + 1);
  }

  void check_quote(const YAML::Mark& mark) {
    const std::string_view rest = text_.substr(std::min(text_.size(), static_cast<std::size_t>(mark.pos)));
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'') || is_closed(rest)) return;
    refuse(place(mark), "the quote that begins here does not end", "close it");
  }

  /// Stores the first error. read() throws it only if the whole text is valid YAML.
  void refuse(const SourceLocation& at, const std::string& reason, const std::string& hint = {}) {
    if (!refused_) refused_ = Error(at.text(), reason, hint);
  }

  SourceLocation place(const YAML::Mark& mark) const {
    return lines_ ? SourceLocation{file_, mark.line + 1, mark.column + 1} : SourceLocation{file_, 0, 0};
  }

  std::shared_ptr<const std::string> file_;
  bool lines_;
  std::string_view text_;
  int documents_ = 0;  ///< number of documents that were read
  int values_ = 0;
  std::size_t text_bytes_ = 0;  ///< total bytes of all texts
  Tree tree_;
  std::vector<OpenContainer> open_;  ///< open lists and maps, the innermost last
  std::map<YAML::anchor_t, Tree> anchors_;
  std::optional<Error> refused_;
};

/// Returns a hint with the config in the folder of `missing` whose name is most similar to the name of `missing`.
std::string similar_file(const std::filesystem::path& missing) {
  std::vector<std::string> names;
  const std::filesystem::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
  for (const std::filesystem::path& file : list_folder(folder)) {
    if (file.extension() == ".yaml") names.push_back(file.filename().string());
  }
  const std::string near = nearest(missing.filename().string(), names);
  return near.empty() ? "name a YAML file" : fmt::format("did you mean '{}'?", near);
}

/// Returns the number of leading bytes that are valid UTF-8.
std::size_t utf8_prefix(std::string_view text) {
  std::size_t valid = 0;
  while (valid < text.size()) {
    const std::size_t length = utf8_length(text.substr(valid));
    if (length == 0) break;
    valid += length;
  }
  return valid;
}

}  // namespace

Tree parse_yaml(const std::string& text, const std::string& file) {
  if (const std::size_t valid = utf8_prefix(text); valid < text.size())
    throw Error(place_in(file, text, valid), "not UTF-8", "save the file as UTF-8");
  try {
    Tree tree = YamlReader(file, true).read(text);
    if (tree.kind == Tree::Kind::null) tree.kind = Tree::Kind::map;
    return tree;
  } catch (
      const YAML::Exception& trouble) {  // converted to Error, so that no exception of the library leaves this file
    const YAML::Mark& mark = trouble.mark;
    const std::string at = mark.is_null() ? file : fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
    if (dynamic_cast<const SecondDocument*>(&trouble) != nullptr)
      throw Error(at, trouble.msg, "remove a '---' or a stray character here or above");
    // yaml-cpp's own message for deep nesting would be "bad file".
    if (dynamic_cast<const YAML::DeepRecursion*>(&trouble) != nullptr)
      throw Error(at, "nested too deeply", "at most 100 levels");
    throw Error(at, "not valid YAML: " + trouble.msg,
                "look here or above for a missing bracket or quote, a wrong indent or a tab");
  }
}

Tree read_yaml(const std::filesystem::path& path, FileOrigin origin) {
  const std::string name = path.lexically_normal().string();
  const FileReading reading = read_bounded(path, kMostConfigBytes, origin);
  const int reason = reading.reason.value();
  std::error_code none;
  switch (reading.kind) {
    case FileReading::Kind::whole:
      return parse_yaml(reading.text, name);
    case FileReading::Kind::absent:
      throw Error(name, "no such file", similar_file(path));
    case FileReading::Kind::not_regular:
      throw Error(name, "not a regular file", "name a YAML file");
    case FileReading::Kind::too_large:
      throw Error(name, "too large for a config", "at most 1 MiB");
    case FileReading::Kind::failed:
      if (reason == EIO) break;
      throw Error(
          name, "cannot be read",
          std::filesystem::exists(path, none) ? "check its permissions" : "check the permissions of its folder");
    case FileReading::Kind::link:
      break;
  }
  const auto [words, remedy] = words_of(reading, kMostConfigBytes);
  throw Error(name, words, remedy, reason == EIO ? Error::Kind::run : Error::Kind::usage);
}

void check_readable(const Tree& config, const std::string& file) {
  // Small configs are accepted without a test, because to_yaml() takes longer than resolve().
  constexpr std::size_t kSmall = 1 << 16;
  if (config.canonical().size() < kSmall) return;
  int values = 0;  // number of values, counted as in Reader
  for_all(config, [&](const Tree&) { ++values; });
  if (to_yaml(config).size() <= kMostConfigBytes && values <= kMaxValues) return;
  throw Error(file, "too large after the defaults are filled in",
              "reduce config.yaml to at most 1 MiB and 100000 values");
}

Tree parse_value(const std::string& text, const std::string& file) {
  // `>` and `|` begin a YAML block, but in an override `>1` is a condition.
  const bool is_block = !text.empty() && (text.front() == '>' || text.front() == '|');
  if (utf8_prefix(text) < text.size()) throw Error(file, "not UTF-8", "write it in UTF-8");
  try {
    if (!is_block) return YamlReader(file, false).read(text);
  } catch (const YAML::Exception&) {  // invalid YAML is a text: see below
  }
  Tree tree = Tree::scalar(text, true);
  tree.place.file = std::make_shared<const std::string>(file);
  return tree;
}

}  // namespace palpate
