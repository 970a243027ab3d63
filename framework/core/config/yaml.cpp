// SPDX-License-Identifier: MIT
#include "config/yaml.hpp"

#include "config/utf8.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

namespace palpate {
namespace {

constexpr std::uintmax_t kMaxBytes = 1 << 20;
/// Aliases share nodes in yaml-cpp, so nine lines can unfold to 10^9 values: count what is unfolded.
constexpr int kMaxValues = 100'000;
constexpr int kMaxDepth = 100;
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

class Converter {
 public:
  /// `text` is what the nodes come from. Without `lines` a place is the file alone: within one word of a command line
  /// they would only confuse.
  Converter(const std::string& file, std::string_view text, bool lines = true)
      : file_(std::make_shared<const std::string>(file)), text_(text), lines_(lines) {}

  Tree convert(const YAML::Node& node, int depth = 0) {
    Tree tree;
    tree.place = place(node.Mark());
    if (++values_ > kMaxValues) throw Error(tree.place.text(), "too many values", "aliases unfold to over 100000");
    if (depth > kMaxDepth) throw Error(tree.place.text(), "nested too deeply", "at most 100 levels");
    // "?" is a plain value, "!" one in quotes or a block; all other tags are written by hand.
    if (const std::string& tag = node.Tag(); !tag.empty() && tag != "?" && tag != "!") {
      throw Error(tree.place.text(), fmt::format("tags ('{}') are not read", tag), "remove it");
    }
    switch (node.Type()) {
      case YAML::NodeType::Undefined:
      case YAML::NodeType::Null:
        break;
      case YAML::NodeType::Scalar:
        tree.kind = Tree::Kind::scalar;
        tree.text = node.Scalar();
        tree.quoted = node.Tag() == "!";
        check_quote(node, tree.place);
        break;
      case YAML::NodeType::Sequence:
        tree.kind = Tree::Kind::list;
        for (const auto& item : node) tree.items.push_back(convert(item, depth + 1));
        break;
      case YAML::NodeType::Map:
        tree.kind = Tree::Kind::map;
        for (const auto& entry : node) add_entry(tree, entry.first, entry.second, depth);
        break;
    }
    return tree;
  }

 private:
  void check_quote(const YAML::Node& node, const Place& at) const {
    const YAML::Mark mark = node.Mark();
    if (node.Tag() != "!" || mark.is_null()) return;
    const std::string_view rest = text_.substr(std::min(text_.size(), static_cast<std::size_t>(mark.pos)));
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'') || is_closed(rest)) return;
    throw Error(at.text(), "the quote that begins here does not end", "close it");
  }

  void add_entry(Tree& map, const YAML::Node& key, const YAML::Node& value, int depth) {
    const Place at = place(key.Mark());
    if (!key.IsScalar()) throw Error(at.text(), "a key must be plain text");
    const std::string& name = key.Scalar();
    check_quote(key, at);
    if (map.entries.size() == kMaxKeys) throw Error(at.text(), "too many keys", "a map has at most 1000");
    if (name == "<<") {
      throw Error(at.text(), "merge keys ('<<') are not read",
                  "repeat the options, or put them into a group file and name it under 'defaults'");
    }
    const auto twin = std::find_if(map.entries.begin(), map.entries.end(),
                                   [&](const Tree::Entry& entry) { return entry.key == name; });
    if (twin != map.entries.end()) {
      throw Error(at.text(), fmt::format("duplicate key '{}'", name),
                  twin->place.line == 0
                      ? "write it once"
                      : fmt::format("it is already at line {}, column {}", twin->place.line, twin->place.column));
    }
    map.entries.push_back({name, at, convert(value, depth + 1)});
    // An absent value (`key:`) has a mark of its own, which may lie on a later line: the key is the better place.
    if (map.entries.back().value.kind == Tree::Kind::null) map.entries.back().value.place = at;
  }

  Place place(const YAML::Mark& mark) const {
    return mark.is_null() || !lines_ ? Place{file_, 0, 0} : Place{file_, mark.line + 1, mark.column + 1};
  }

  std::shared_ptr<const std::string> file_;
  std::string_view text_;
  bool lines_;
  int values_ = 0;
};

std::string place_text(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
}

/// Keeps where a document's content begins.
class Beginning : public YAML::EventHandler {
 public:
  std::optional<YAML::Mark> mark;

  void OnDocumentStart(const YAML::Mark&) override { mark.reset(); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& at, YAML::anchor_t) override { note(at); }
  void OnAlias(const YAML::Mark& at, YAML::anchor_t) override { note(at); }
  void OnScalar(const YAML::Mark& at, const std::string&, YAML::anchor_t, const std::string&) override { note(at); }
  void OnSequenceStart(const YAML::Mark& at, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    note(at);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& at, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    note(at);
  }
  void OnMapEnd() override {}

 private:
  void note(const YAML::Mark& at) {
    if (!mark) mark = at;
  }
};

/// Where the second document of `text` begins, if there is one. It is not asked for a third: after a stray comma
/// yaml-cpp finds one document after the other without ever going on.
std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  Beginning beginning;
  parser.HandleNextDocument(beginning);
  return parser.HandleNextDocument(beginning) ? beginning.mark : std::nullopt;
}

YAML::Node load(const std::string& text, const std::string& file) {
  try {
    if (const std::optional<YAML::Mark> second = second_document(text)) {
      throw Error(place_text(file, *second), "a second document begins here",
                  "remove a '---' or a stray sign here or before");
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& trouble) {  // thrown on as an Error: the library's own goes no further
    // yaml-cpp's message for deep nesting is "bad file", which misleads.
    const bool deep = dynamic_cast<const YAML::DeepRecursion*>(&trouble) != nullptr;
    throw Error(
        place_text(file, trouble.mark), deep ? "nested too deeply" : fmt::format("not valid YAML: {}", trouble.msg),
        deep ? "at most 100 levels" : "look here or above for a missing bracket or quote, a wrong indent or a tab");
  }
}

void emit(YAML::Emitter& out, const Tree& tree) {
  switch (tree.kind) {
    case Tree::Kind::null:
      out << YAML::Null;
      break;
    case Tree::Kind::scalar:
      if (tree.quoted) out << YAML::DoubleQuoted;
      out << tree.text;
      break;
    case Tree::Kind::list: {
      const bool flat = std::all_of(tree.items.begin(), tree.items.end(), [](const Tree& item) {
        return item.kind == Tree::Kind::scalar || item.kind == Tree::Kind::null;
      });
      if (flat) out << YAML::Flow;
      out << YAML::BeginSeq;
      for (const Tree& item : tree.items) emit(out, item);
      out << YAML::EndSeq;
      break;
    }
    case Tree::Kind::map:
      if (tree.entries.empty()) out << YAML::Flow;
      out << YAML::BeginMap;
      for (const Tree::Entry& entry : tree.entries) {
        out << YAML::Key << entry.key << YAML::Value;
        emit(out, entry.value);
      }
      out << YAML::EndMap;
      break;
  }
}

/// As Converter counts them.
int count_values(const Tree& tree) {
  int count = 1;
  for (const Tree& item : tree.items) count += count_values(item);
  for (const Tree::Entry& entry : tree.entries) count += count_values(entry.value);
  return count;
}

/// The config beside `missing` whose name is nearest to its own, as a hint.
std::string similar_file(const std::filesystem::path& missing) {
  std::vector<std::string> names;
  std::error_code none;
  const std::filesystem::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string near = nearest(missing.filename().string(), names);
  return near.empty() ? "name a YAML file" : fmt::format("did you mean '{}'?", near);
}

}  // namespace

Tree parse_yaml(const std::string& text, const std::string& file) {
  if (const std::size_t valid = utf8_prefix(text); valid < text.size()) {
    throw Error(place_in(file, text, valid), "not UTF-8", "save the file as UTF-8");
  }
  // Marks do not count it.
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  const std::string_view content =
      std::string_view(text).substr(text.rfind(kByteOrderMark, 0) == 0 ? kByteOrderMark.size() : 0);
  Tree tree = Converter(file, content).convert(load(text, file));
  if (tree.kind == Tree::Kind::null) tree.kind = Tree::Kind::map;
  return tree;
}

Tree read_yaml(const std::filesystem::path& path) {
  const std::string name = path.lexically_normal().string();
  std::error_code trouble;
  const auto status = std::filesystem::status(path, trouble);
  if (trouble == std::errc::permission_denied)
    throw Error(name, "cannot be read", "check the permissions of its folder");
  if (!std::filesystem::exists(status)) throw Error(name, "no such file", similar_file(path));
  if (!std::filesystem::is_regular_file(status)) throw Error(name, "not a regular file", "name a YAML file");
  const auto bytes = std::filesystem::file_size(path, trouble);
  if (trouble || bytes > kMaxBytes) throw Error(name, "too large for a config", "at most 1 MiB");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(name, "cannot be read", "check its permissions");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_yaml(text, name);
}

void check_readable(const Tree& config, const std::string& file) {
  // To write it takes longer than to resolve it, and hardly any config comes near the limit.
  constexpr std::size_t kSmall = 1 << 16;
  if (config.canonical().size() < kSmall) return;
  if (to_yaml(config).size() <= kMaxBytes && count_values(config) <= kMaxValues) return;
  throw Error(file, "too large with all that it leaves to defaults", "at most 1 MiB and 100000 values in config.yaml");
}

Tree parse_value(const std::string& text, const std::string& file) {
  // A block has lines below its sign; here, `>1` is what someone expects of a number.
  const bool is_block = !text.empty() && (text.front() == '>' || text.front() == '|');
  if (utf8_prefix(text) < text.size()) throw Error(file, "not UTF-8", "write it in UTF-8");
  std::optional<YAML::Node> document;
  try {
    if (!is_block && !second_document(text)) document = YAML::Load(text);
  } catch (const YAML::Exception&) {  // then it is text: see below
  }
  if (document) return Converter(file, text, false).convert(*document);
  Tree tree = Tree::scalar(text, true);
  tree.place.file = std::make_shared<const std::string>(file);
  return tree;
}

std::string to_yaml(const Tree& tree) {
  YAML::Emitter out;
  emit(out, tree);
  return std::string(out.c_str()) + "\n";
}

}  // namespace palpate
