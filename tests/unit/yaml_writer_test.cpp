// SPDX-License-Identifier: MIT
// Configs are written to the letter as yaml-cpp writes them.
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
