// SPDX-License-Identifier: MIT
// Writes YAML: to_yaml(), and to_yaml_with_places() with source locations in comments.
#include "config/yaml.hpp"
#include "reading/read_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Returns the YAML that yaml-cpp writes for a scalar with special characters. `in_brackets`: whether the scalar is an
/// item of a list in brackets.
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

/// Returns whether a text is a word, name or number that never needs quotes. For other texts, yaml-cpp decides whether
/// quotes are needed.
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

const SourceLocation kNowhere;

/// Appends a comment with the source location of a value. If the value has none, the comment contains `around`, the
/// location of the list around the value. Appends nothing for a map, because its values have their own locations.
void append_place(std::string& out, const Tree& value, const SourceLocation& around) {
  if (value.is_map()) return;
  const SourceLocation& known = value.place.file ? value.place : around;
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

/// Appends a tree whose first line begins at `column`, the current end of `out`. Adds comments with source locations if
/// `around` is not null.
void append_block(std::string& out, const Tree& tree, std::size_t column, const SourceLocation* around) {
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

}  // namespace

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
