// SPDX-License-Identifier: MIT
#include "config/yaml.hpp"

#include "reading/reading.hpp"

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
#include <vector>

namespace palpate {
namespace {

/// Nine lines of aliases can unfold to 10^9 values: what is unfolded counts.
constexpr int kMaxValues = 100'000;
constexpr std::size_t kMaxDepth = 100;
/// Of all texts, unfolded; to_yaml() writes no config of more than a quarter of it.
constexpr std::size_t kMaxTextBytes = 4 << 20;
/// Nobody writes so many, and keys are looked for one after the other.
constexpr std::size_t kMaxKeys = 1000;

/// Whether the quoted scalar of which `text` begins with the quote comes to its end; yaml-cpp takes the end of the text
/// for it as well, and the rest of a config for the name of an experiment.
bool is_closed(std::string_view text) {
  const char quote = text.front();
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 == text.size() || text[i + 1] != quote) return true;
      ++i;  // two of them stand for one
    }
  }
  return false;
}

/// A second document begins where the text should end.
class SecondDocument : public YAML::Exception {
 public:
  explicit SecondDocument(const YAML::Mark& at) : Exception(at, "a second document begins here") {}
};

/// Builds the tree of a text from what the parser meets in it.
class Reader final : public YAML::EventHandler {
 public:
  /// Without `lines` a place is the file alone: within one word of a command line they would only confuse.
  Reader(const std::string& file, bool lines) : file_(std::make_shared<const std::string>(file)), lines_(lines) {
    tree_.place.file = file_;
  }

  /// The tree of the only document, null for an empty one. Throws YAML::Exception for what is no YAML, whatever else is
  /// wrong in it, and Error for what is.
  Tree read(const std::string& text) {
    // Marks do not count it.
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    text_ = std::string_view(text).substr(text.rfind(kByteOrderMark, 0) == 0 ? kByteOrderMark.size() : 0);
    std::istringstream in(text);
    YAML::Parser parser(in);
    // It is not asked for a third: after a stray comma yaml-cpp finds one document after the other without ever going
    // on.
    for (; documents_ < 2; ++documents_) parser.HandleNextDocument(*this);
    if (refused_) throw *refused_;
    return std::move(tree_);
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { put(mark, "", anchor, Tree()); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (refused_) return;                      // what it stands for may be long
    const auto found = anchors_.find(anchor);  // none where it stands for what it is a part of
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
  /// A list or map to which the next values belong. It does not move: only the innermost grows.
  struct Open {
    Tree* tree;  ///< null once the text is refused
    YAML::anchor_t anchor;
    bool has_key;  ///< of a map: what comes next is the value of its last key
  };

  void close() {
    if (open_.back().anchor != YAML::NullAnchor && !refused_) anchors_[open_.back().anchor] = *open_.back().tree;
    open_.pop_back();
  }

  /// Takes the next key or value; what an alias stands for has its place. Returns where a value went.
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
      // An absent value (`key:`) has a mark of its own, which may lie on a later line: the key is the better place.
      if (around.is_map() && value.kind == Tree::Kind::null) value.place = around.entries.back().place;
    }
    // "?" is a plain value, "!" one in quotes or a block; all other tags are written by hand.
    if (!tag.empty() && tag != "?" && tag != "!") {
      refuse(value.place, fmt::format("tags ('{}') are not supported", tag), "remove it");
    }
    count(value, open_.size());
    *slot = std::move(value);
    return slot;
  }

  Tree* add_key(Tree& map, const Tree& key) {
    if (!key.is_scalar()) refuse(key.place, "a key must be plain text");
    if (map.entries.size() == kMaxKeys) refuse(key.place, "too many keys", "a map has at most 1000");
    if (key.text == "<<") {
      refuse(key.place, "merge keys ('<<') are not supported",
             "repeat the options, or put them into a group file and name it under 'defaults'");
    }
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

  /// Counts a value that lies so deep, and all in it, which only an alias brings along.
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

  /// Of what is refused the first is told, and only if the text is YAML to its end.
  void refuse(const Place& at, const std::string& reason, const std::string& hint = {}) {
    if (!refused_) refused_ = Error(at.text(), reason, hint);
  }

  Place place(const YAML::Mark& mark) const {
    return lines_ ? Place{file_, mark.line + 1, mark.column + 1} : Place{file_, 0, 0};
  }

  std::shared_ptr<const std::string> file_;
  bool lines_;
  std::string_view text_;
  int documents_ = 0;  ///< that were read
  int values_ = 0;
  std::size_t text_bytes_ = 0;  ///< in them
  Tree tree_;
  std::vector<Open> open_;  ///< the innermost last
  std::map<YAML::anchor_t, Tree> anchors_;
  std::optional<Error> refused_;
};

/// A scalar as the library writes it, within brackets or not: what has signs of YAML's in it.
std::string odd_scalar(const Tree& scalar, bool in_brackets) {
  YAML::Emitter out;
  if (in_brackets) out << YAML::Flow << YAML::BeginSeq;
  if (scalar.quoted) out << YAML::DoubleQuoted;
  out << scalar.text;
  if (!in_brackets) return out.c_str();
  out << YAML::EndSeq;
  const std::string text = out.c_str();
  return text.substr(1, text.size() - 2);
}

bool is_alnum(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool is_one_of(char c, std::string_view these) { return these.find(c) != std::string_view::npos; }

/// Whether a text is a word, a name or a number that needs no quotes anywhere in a config. Other texts may not need
/// them either; yaml-cpp decides.
bool is_plain_word(std::string_view text) {
  if (text.empty() || text.back() == ' ' || text == "null" || text == "Null" || text == "NULL") return false;
  const bool is_number = text.front() == '-' && text.size() > 1 && (is_alnum(text[1]) || text[1] == '.');
  return (is_number || is_alnum(text.front()) || is_one_of(text.front(), "_./+")) &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_alnum(c) || is_one_of(c, " _./+-*()=<>%^"); });
}

void append_scalar(std::string& out, const Tree& scalar, bool in_brackets) {
  const auto stays = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  if (!scalar.quoted && is_plain_word(scalar.text)) {
    out += scalar.text;
  } else if (scalar.quoted && std::all_of(scalar.text.begin(), scalar.text.end(), stays)) {
    out.append("\"").append(scalar.text) += '"';
  } else {
    out += odd_scalar(scalar, in_brackets);
  }
}

bool is_in_line(const Tree& tree) {
  const auto is_leaf = [](const Tree& item) {
    return item.kind == Tree::Kind::scalar || item.kind == Tree::Kind::null;
  };
  return is_leaf(tree) ||
         (tree.is_map() ? tree.entries.empty() : std::all_of(tree.items.begin(), tree.items.end(), is_leaf));
}

void append_in_line(std::string& out, const Tree& tree, bool in_brackets = false) {
  if (tree.is_scalar()) return append_scalar(out, tree, in_brackets);
  if (tree.is_map()) {
    out += "{}";
  } else if (tree.kind == Tree::Kind::null) {
    out += '~';
  } else {
    const char* separator = "[";
    for (const Tree& item : tree.items) {
      out += std::exchange(separator, ", ");
      append_in_line(out, item, true);
    }
    out += tree.items.empty() ? "[]" : "]";
  }
}

constexpr std::string_view kComment = "  # ";

const Place kNowhere;

/// Behind a value: where it is from, which is where the list around it is from if it does not know. A group without
/// options is no value.
void append_place(std::string& out, const Tree& value, const Place& around) {
  if (value.is_map()) return;
  const Place& known = value.place.file ? value.place : around;
  out += kComment;
  if (!known.file) {
    out += "default";
    return;
  }
  const auto is_plain = [](char c) { return c >= ' ' && c <= '~'; };
  if (std::all_of(known.file->begin(), known.file->end(), is_plain)) {
    out += *known.file;
  } else {
    std::string text = printable(*known.file);
    std::replace(text.begin(), text.end(), '\n', ' ');
    out += text;
  }
  if (known.line > 0) out.append(":").append(std::to_string(known.line)).append(":") += std::to_string(known.column);
}

/// A tree whose first line begins in that column, where `out` ends; with places if `around` is not null.
void append_block(std::string& out, const Tree& tree, std::size_t column, const Place* around) {
  if (is_in_line(tree)) {
    append_in_line(out, tree);
    if (around != nullptr) append_place(out, tree, *around);
    return;
  }
  if (around != nullptr && tree.kind == Tree::Kind::list && tree.place.file) around = &tree.place;
  bool first = true;
  const auto begin_line = [&] {
    if (!std::exchange(first, false)) out.append("\n").append(column, ' ');
  };
  const auto append_below = [&](const Tree& value) {
    out.append("\n").append(column + 2, ' ');
    append_block(out, value, column + 2, around);
  };
  for (const Tree& item : tree.items) {
    begin_line();
    out += '-';
    if (item.kind == Tree::Kind::list && !is_in_line(item)) {
      append_below(item);
    } else {
      out += ' ';
      append_block(out, item, column + 2, around);
    }
  }
  if (around != nullptr && tree.is_map()) around = &kNowhere;
  for (const Tree::Entry& entry : tree.entries) {
    begin_line();
    append_scalar(out, Tree::scalar(entry.key), false);
    out += ':';
    if (is_in_line(entry.value)) {
      out += ' ';
      append_block(out, entry.value, column, around);
    } else {
      append_below(entry.value);
    }
  }
}

/// The config beside `missing` whose name is nearest to its own, as a hint.
std::string similar_file(const std::filesystem::path& missing) {
  std::vector<std::string> names;
  const std::filesystem::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
  for (const std::filesystem::path& file : list_folder(folder)) {
    if (file.extension() == ".yaml") names.push_back(file.filename().string());
  }
  const std::string near = nearest(missing.filename().string(), names);
  return near.empty() ? "name a YAML file" : fmt::format("did you mean '{}'?", near);
}

/// How many of the first bytes are UTF-8.
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
  if (const std::size_t valid = utf8_prefix(text); valid < text.size()) {
    throw Error(place_in(file, text, valid), "not UTF-8", "save the file as UTF-8");
  }
  try {
    Tree tree = Reader(file, true).read(text);
    if (tree.kind == Tree::Kind::null) tree.kind = Tree::Kind::map;
    return tree;
  } catch (const YAML::Exception& trouble) {  // thrown on as an Error: the library's own goes no further
    const YAML::Mark& mark = trouble.mark;
    const std::string at = mark.is_null() ? file : fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
    if (dynamic_cast<const SecondDocument*>(&trouble) != nullptr)
      throw Error(at, trouble.msg, "remove a '---' or a stray character here or above");
    // yaml-cpp's own words are "bad file", which mislead.
    if (dynamic_cast<const YAML::DeepRecursion*>(&trouble) != nullptr)
      throw Error(at, "nested too deeply", "at most 100 levels");
    throw Error(at, "not valid YAML: " + trouble.msg,
                "look here or above for a missing bracket or quote, a wrong indent or a tab");
  }
}

Tree read_yaml(const std::filesystem::path& path, Origin origin) {
  const std::string name = path.lexically_normal().string();
  const Reading reading = read_bounded(path, kMostConfigBytes, origin);
  const int reason = reading.reason.value();
  std::error_code none;
  switch (reading.kind) {
    case Reading::Kind::whole:
      return parse_yaml(reading.text, name);
    case Reading::Kind::absent:
      throw Error(name, "no such file", similar_file(path));
    case Reading::Kind::not_regular:
      throw Error(name, "not a regular file", "name a YAML file");
    case Reading::Kind::too_large:
      throw Error(name, "too large for a config", "at most 1 MiB");
    case Reading::Kind::failed:
      if (reason == EIO) break;
      throw Error(
          name, "cannot be read",
          std::filesystem::exists(path, none) ? "check its permissions" : "check the permissions of its folder");
    case Reading::Kind::link:
      break;
  }
  const auto [words, remedy] = words_of(reading, kMostConfigBytes);
  throw Error(name, words, remedy, reason == EIO ? Error::Kind::run : Error::Kind::usage);
}

void check_readable(const Tree& config, const std::string& file) {
  // To write it takes longer than to resolve it, and hardly any config comes near the limit.
  constexpr std::size_t kSmall = 1 << 16;
  if (config.canonical().size() < kSmall) return;
  int values = 0;  // as Reader counts them
  for_all(config, [&](const Tree&) { ++values; });
  if (to_yaml(config).size() <= kMostConfigBytes && values <= kMaxValues) return;
  throw Error(file, "too large after the defaults are filled in",
              "reduce config.yaml to at most 1 MiB and 100000 values");
}

Tree parse_value(const std::string& text, const std::string& file) {
  // A block has lines below its sign; here, `>1` is what someone expects of a number.
  const bool is_block = !text.empty() && (text.front() == '>' || text.front() == '|');
  if (utf8_prefix(text) < text.size()) throw Error(file, "not UTF-8", "write it in UTF-8");
  try {
    if (!is_block) return Reader(file, false).read(text);
  } catch (const YAML::Exception&) {  // then it is text: see below
  }
  Tree tree = Tree::scalar(text, true);
  tree.place.file = std::make_shared<const std::string>(file);
  return tree;
}

std::string to_yaml(const Tree& tree) {
  std::string out;
  append_block(out, tree, 0, nullptr);
  return out + "\n";
}

std::string to_yaml_with_places(const Tree& tree) {
  std::string out;
  append_block(out, tree, 0, &kNowhere);
  return out.size() < kMostConfigBytes ? out + "\n" : to_yaml(tree);
}

std::vector<std::string> places_of_lines(std::string_view text) {
  std::vector<std::string> out(1);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t comment = line.rfind(kComment);
    out.emplace_back(comment == std::string_view::npos ? "" : line.substr(comment + kComment.size()));
  }
  return out;
}

}  // namespace palpate
