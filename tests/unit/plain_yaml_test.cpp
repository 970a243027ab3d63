// SPDX-License-Identifier: MIT
// What is read and written without yaml-cpp, against yaml-cpp.
#include "config/plain_yaml.hpp"

#include "config/yaml.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

/// All that is in a tree, the places included.
std::string all_of(const Tree& tree) {
  const auto at = [](const Place& place) { return fmt::format("{}:{}", place.line, place.column); };
  std::string out = fmt::format("{}{}'{}'@{}", static_cast<int>(tree.kind), tree.quoted, tree.text, at(tree.place));
  for (const Tree& item : tree.items) out += "[" + all_of(item) + "]";
  for (const Tree::Entry& entry : tree.entries)
    out += "{'" + entry.key + "'@" + at(entry.place) + ": " + all_of(entry.value) + "}";
  return out;
}

std::optional<Tree> read_plain(const std::string& text) {
  return read_plain_yaml(text, std::make_shared<const std::string>("c.yaml"));
}

/// By the reader of all YAML, to which a sign that is not ASCII sends it.
std::string read_by_the_library(const std::string& text) {
  try {
    return all_of(parse_yaml(text + "\n# \xc3\xa4\n", "c.yaml"));
  } catch (const Error& trouble) {
    return trouble.what();
  }
}

std::vector<std::string> shipped_texts() {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_folder() / "configs")) {
    if (entry.path().extension() != ".yaml") continue;
    std::ifstream in(entry.path());
    out.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(PlainYaml, IsWhatNearlyAllShippedConfigsAreWrittenIn) {
  const std::vector<std::string> texts = shipped_texts();
  const auto plain = std::count_if(texts.begin(), texts.end(), [](const auto& text) { return read_plain(text); });
  EXPECT_GE(static_cast<std::size_t>(plain) + 5, texts.size());
}

TEST(PlainYaml, IsReadWithEveryPlaceAsTheLibraryReadsIt) {
  const std::vector<std::string> texts = shipped_texts();
  for (const std::string& text : texts) {
    const std::optional<Tree> tree = read_plain(text);
    if (!tree) continue;
    EXPECT_EQ(all_of(*tree), read_by_the_library(text));
  }
}

TEST(PlainYaml, IsLeftToTheLibraryWhereAnythingElseIsInIt) {
  for (const char* text : {"",
                           "# nothing\n",
                           "word\n",

                           " a: 1\n",
                           "a: 1\na: 2\n",
                           "a: b: c\n",
                           "a:b\n",
                           "a: b\n  c\n",
                           "a: 'b''c'\n",
                           "a: \"b\\n\"\n",
                           "a: |\n  b\n",
                           "a: &x b\n",
                           "a: *x\n",
                           "a: !t b\n",
                           "? a\n: b\n",
                           "a: ~\n",
                           "a: null\n",
                           "null: a\n",
                           "a: [b\n",
                           "a: [b,\n  c]\n",
                           "a: [b, ]\n",
                           "a: {b}\n",
                           "a: {b: }\n",
                           "a: [b]c\n",
                           "a: [b]#c\n",
                           "a: b#c\n",
                           "a:\tb\n",
                           "a: b\r\n",
                           "---\na: b\n",
                           "a: b\n---\n",
                           "a: b\n...\n",
                           "%YAML 1.2\n",
                           "<<: {a: b}\n",
                           "a:\n- b\n",
                           "a:\n  - - b\n",
                           "a:\n  - b\n  c: d\n",
                           "a:\n    b: 1\n  c: 2\n",
                           "a: \xc3\xa4\n",
                           "a: - b\n",
                           "a: -\n",
                           "a: ' b'\n",
                           "'a': b\n"}) {
    EXPECT_FALSE(read_plain(text)) << text;
  }
}

TEST(PlainYaml, IsReadAsTheLibraryReadsItWhateverIsChangedInIt) {
  const std::vector<std::string> texts = shipped_texts();
  const std::vector<std::string> signs{": ", "- ", " #",  "\n  ", "\n- ", "[",    "]",  "{",  "}",  ",", "'", "\"",
                                       "~",  "?",  "\n",  " ",    "  ",   "null", "&a", "*a", "!a", "|", ">", "%",
                                       ":",  "#",  "---", "...",  "<<: ", "a: b", "\\", "\t", "=",  ".", "-", "+"};
  std::mt19937_64 random(3);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  int plain = 0;
  const int cases = brief() ? 3000 : 30000;
  for (int i = 0; i < cases; ++i) {
    std::string text = texts[below(texts.size())];
    // A few lines of it, so that what is changed is not lost among what is not.
    const std::size_t from = text.rfind('\n', below(text.size()));
    text = text.substr(from == std::string::npos ? 0 : from + 1, 20 + below(400));
    for (std::size_t changes = below(4); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size());
      if (below(3) == 0) {
        text.erase(at, 1 + below(4));
      } else {
        text.insert(at, signs[below(signs.size())]);
      }
    }
    const std::optional<Tree> tree = read_plain(text);
    if (!tree) continue;
    ++plain;
    ASSERT_EQ(all_of(*tree), read_by_the_library(text)) << text;
  }
  EXPECT_GT(plain, cases / 20);
}

/// As it was written when yaml-cpp wrote all of it.
void emit(YAML::Emitter& out, const Tree& tree) {
  const auto is_leaf = [](const Tree& item) { return !item.is_map() && item.kind != Tree::Kind::list; };
  if (tree.kind == Tree::Kind::null) {
    out << YAML::Null;
  } else if (tree.is_scalar()) {
    if (tree.quoted) out << YAML::DoubleQuoted;
    out << tree.text;
  } else if (tree.is_map()) {
    if (tree.entries.empty()) out << YAML::Flow;
    out << YAML::BeginMap;
    for (const Tree::Entry& entry : tree.entries) {
      out << YAML::Key << entry.key << YAML::Value;
      emit(out, entry.value);
    }
    out << YAML::EndMap;
  } else {
    if (std::all_of(tree.items.begin(), tree.items.end(), is_leaf)) out << YAML::Flow;
    out << YAML::BeginSeq;
    for (const Tree& item : tree.items) emit(out, item);
    out << YAML::EndSeq;
  }
}

TEST(YamlWriter, WritesToTheLetterWhatTheLibraryWrites) {
  const std::vector<std::string> words{
      "a",     "0.1 m", "",     "~",        "null",     "NULL", "x: y", "x:y", "a #b",         "a#b",    "- a",  "-a",
      "-1",    "-.5",   "--",   "-",        "[a",       "a,b",  "a]",   "{",   "'q'",          "\"d\"",  "\\",   "a\tb",
      "a\nb",  "?",     "?a",   "&a",       "*a",       "!a",   "|",    "> x", "%a",           "@a",     "`a",   "a ",
      " a",    "a  b",  "true", "1e-05",    "a:",       ":a",   ".",    "...", "---",          "/a/b",   "+1",   "=1",
      "a=b",   "(x)",   "a?b",  "x\xff",    "\x01",     "\x7f", "Null", "<<",  "\xc3\xa4",     "a*b",    "a<b>", "\r",
      "a%b^c", "nUll",  "a\"b", "\xc2\xa0", "\xc2\x85", "a\\b", "a'b",  "a{b", "\xe2\x82\xac", "a.b-c_d"};
  std::mt19937_64 random(4);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  const auto word = [&] { return words[below(words.size())] + (below(6) == 0 ? words[below(words.size())] : ""); };
  const std::function<Tree(int)> drawn = [&](int level) {
    Tree out;
    const std::size_t kind = below(level > 4 ? 4 : 10);
    if (kind == 0) return out;
    if (kind < 4) return Tree::scalar(word(), below(3) == 0);
    out = kind < 7 ? Tree::list() : Tree::map();
    for (std::size_t count = below(4); count > 0; --count) {
      if (out.is_map()) {
        out.entries.push_back({word(), {}, drawn(level + 1)});
      } else {
        out.items.push_back(drawn(level + 1));
      }
    }
    return out;
  };
  for (int i = 0; i < (brief() ? 3000 : 30000); ++i) {
    const Tree tree = drawn(0);
    YAML::Emitter out;
    emit(out, tree);
    ASSERT_EQ(to_yaml(tree), out.c_str() + std::string("\n"));
  }
}

}  // namespace
}  // namespace palpate::test
