// SPDX-License-Identifier: MIT
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace palpate {
namespace {

constexpr std::uintmax_t kMaxBytes = 1 << 20;
/// Aliases share nodes in yaml-cpp, so nine lines can unfold to 10^9 values: count what is unfolded.
constexpr int kMaxValues = 100'000;
constexpr int kMaxDepth = 100;

class Converter {
 public:
  /// Without `lines` a place is the file alone: within one word of a command line they would only confuse.
  explicit Converter(const std::string& file, bool lines = true)
      : file_(std::make_shared<const std::string>(file)), lines_(lines) {}

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
  void add_entry(Tree& map, const YAML::Node& key, const YAML::Node& value, int depth) {
    const Place at = place(key.Mark());
    if (!key.IsScalar()) throw Error(at.text(), "a key must be plain text");
    const std::string& name = key.Scalar();
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
  bool lines_;
  int values_ = 0;
};

std::string place_text(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
}

YAML::Node load(const std::string& text, const std::string& file) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw Error(place_text(file, documents[1].Mark()), "a second document begins here", "remove the '---' before it");
    }
    return documents.empty() ? YAML::Node(YAML::NodeType::Map) : documents.front();
  } catch (const YAML::Exception& trouble) {
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
  Tree tree = Converter(file).convert(load(text, file));
  if (tree.kind == Tree::Kind::null) tree.kind = Tree::Kind::map;
  return tree;
}

Tree read_yaml(const std::filesystem::path& path) {
  const std::string name = path.lexically_normal().string();
  std::error_code trouble;
  const auto status = std::filesystem::status(path, trouble);
  if (!std::filesystem::exists(status)) throw Error(name, "no such file", similar_file(path));
  if (!std::filesystem::is_regular_file(status)) throw Error(name, "not a regular file", "name a YAML file");
  const auto bytes = std::filesystem::file_size(path, trouble);
  if (trouble || bytes > kMaxBytes) throw Error(name, "too large for a config", "at most 1 MiB");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(name, "cannot be read", "check its permissions");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_yaml(text, name);
}

Tree parse_value(const std::string& text, const std::string& file) {
  // A block has lines below its sign; here, `>1` is what someone expects of a number.
  const bool is_block = !text.empty() && (text.front() == '>' || text.front() == '|');
  try {
    if (!is_block) return Converter(file, false).convert(YAML::Load(text));
  } catch (const YAML::Exception&) {
  }
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
