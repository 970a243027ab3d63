// SPDX-License-Identifier: MIT
#include "config/plain_yaml.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// So little that neither the values nor the levels that a config may have are too many.
constexpr std::size_t kMostBytes = 1 << 16;
constexpr int kMostLevels = 20;

bool is_alnum(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool is_one_of(char c, std::string_view these) { return these.find(c) != std::string_view::npos; }

bool is_null_word(std::string_view text) { return text == "null" || text == "Null" || text == "NULL"; }

/// What begins a word and cannot begin anything else.
bool begins_word(std::string_view text) {
  if (text.empty()) return false;
  if (text.front() == '-') return text.size() > 1 && (is_alnum(text[1]) || text[1] == '.');
  return is_alnum(text.front()) || is_one_of(text.front(), "_./+");
}

/// What a word may have within it wherever it stands.
bool is_of_word(char c) { return is_alnum(c) || is_one_of(c, " _./+-*()=<>%^"); }

/// What is none of this, as the reader meets it.
struct Unfamiliar {};

class PlainReader {
 public:
  PlainReader(std::string_view text, const std::shared_ptr<const std::string>& file) : file_(file) {
    int number = 1;
    while (!text.empty()) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(line.size() + 1, text.size()));
      const std::size_t indent = line.find_first_not_of(' ');
      if (indent != std::string_view::npos && line[indent] != '#') lines_.push_back({line, number, indent});
      ++number;
    }
  }

  Tree read() {
    if (lines_.empty() || lines_.front().begin != 0) throw Unfamiliar();
    Tree tree = block(0);
    if (next_ != lines_.size()) throw Unfamiliar();
    return tree;
  }

 private:
  /// A line with something but a comment in it.
  struct Line {
    std::string_view text;
    int number;
    std::size_t begin;  ///< of what is not read yet; the column of an entry of a block
  };

  bool has_line() const { return next_ < lines_.size(); }
  Line& line() { return lines_[next_]; }
  std::string_view rest() { return line().text.substr(line().begin); }
  Place place() { return {file_, line().number, static_cast<int>(line().begin) + 1}; }
  void skip(std::size_t characters) { line().begin += characters; }
  void skip_spaces() { skip(std::min(rest().find_first_not_of(' '), rest().size())); }
  void take(char expected) {
    if (rest().empty() || rest().front() != expected) throw Unfamiliar();
    skip(1);
  }
  bool at_item() { return rest().substr(0, 2) == "- "; }

  /// Behind a value: nothing but a comment may follow on its line.
  void end_line() {
    const std::size_t before = line().begin;
    skip_spaces();
    if (!rest().empty() && (rest().front() != '#' || line().begin == before)) throw Unfamiliar();
    ++next_;
  }

  /// The block of which the first entry begins where the line is read.
  Tree block(int level) {
    if (level > kMostLevels) throw Unfamiliar();
    const std::size_t column = line().begin;
    const bool is_list = at_item();
    Tree out = is_list ? Tree::list() : Tree::map();
    out.place = place();
    do {
      if (at_item() != is_list) throw Unfamiliar();
      if (is_list) {
        skip(1);
        skip_spaces();
        if (at_item()) throw Unfamiliar();
        out.items.push_back(is_entry() ? block(level + 1) : inline_value());
      } else {
        add_entry(out, level);
      }
    } while (has_line() && line().begin == column);
    // What is farther in carries on what stands before it.
    if (has_line() && line().begin > column) throw Unfamiliar();
    return out;
  }

  /// Whether a map begins here.
  bool is_entry() {
    const std::string_view text = rest();
    const std::size_t end = key_length();
    return end > 0 && end < text.size() && text[end] == ':';
  }

  std::size_t key_length() {
    const std::string_view text = rest();
    if (!begins_word(text)) return 0;
    std::size_t end = 1;
    while (end < text.size() && is_of_word(text[end]) && text[end] != ' ') ++end;
    return end;
  }

  void add_entry(Tree& map, int level) {
    const std::size_t column = line().begin;
    open_entry(map);
    Tree::Entry& entry = map.entries.back();
    skip_spaces();
    if (!rest().empty() && rest().front() != '#') {
      entry.value = inline_value();
      return;
    }
    ++next_;
    if (has_line() && line().begin > column) {
      entry.value = block(level + 1);
    } else if (has_line() && line().begin == column && at_item()) {
      throw Unfamiliar();
    } else {
      entry.value.place = entry.place;
    }
  }

  /// Reads a key and its colon.
  void open_entry(Tree& map) {
    const std::size_t length = key_length();
    const std::string_view key = rest().substr(0, length);
    if (length == 0 || is_null_word(key) || map.find(key) != nullptr) throw Unfamiliar();
    map.entries.push_back({std::string(key), place(), {}});
    skip(length);
    take(':');
    if (!rest().empty() && rest().front() != ' ') throw Unfamiliar();
  }

  /// What stands on one line to its end.
  Tree inline_value() {
    Tree out = value(false, 0);
    end_line();
    return out;
  }

  Tree value(bool in_brackets, int level) {
    if (rest().empty() || level > kMostLevels) throw Unfamiliar();
    const Place at = place();
    Tree out;
    switch (rest().front()) {
      case '[':
      case '{':
        out = bracketed(level);
        break;
      case '"':
      case '\'':
        out = quoted();
        break;
      default:
        out = word(in_brackets);
    }
    out.place = at;
    return out;
  }

  Tree bracketed(int level) {
    const bool is_list = rest().front() == '[';
    const char end = is_list ? ']' : '}';
    Tree out = is_list ? Tree::list() : Tree::map();
    skip(1);
    skip_spaces();
    while (rest().empty() || rest().front() != end || !out.items.empty() || !out.entries.empty()) {
      if (is_list) {
        out.items.push_back(value(true, level + 1));
      } else {
        open_entry(out);
        skip_spaces();
        out.entries.back().value = value(true, level + 1);
      }
      skip_spaces();
      if (!rest().empty() && rest().front() == end) break;
      take(',');
      skip_spaces();
    }
    take(end);
    return out;
  }

  Tree quoted() {
    const char quote = rest().front();
    skip(1);
    const std::string_view text = rest().substr(0, rest().find(quote));
    // Its own rules hold for a space at an end, for a quote in it and for what a backslash begins.
    if (text.size() == rest().size() || text.find('\\') != std::string_view::npos) throw Unfamiliar();
    if (!text.empty() && (text.front() == ' ' || text.back() == ' ')) throw Unfamiliar();
    skip(text.size() + 1);
    if (!rest().empty() && !is_one_of(rest().front(), " ,]}")) throw Unfamiliar();
    return Tree::quote(std::string(text));
  }

  Tree word(bool in_brackets) {
    if (!begins_word(rest())) throw Unfamiliar();
    std::string_view text = rest();
    std::size_t end = 0;
    // Out of brackets they and commas are characters as others are.
    while (end < text.size() && (is_of_word(text[end]) || (!in_brackets && is_one_of(text[end], ",[]{}")))) ++end;
    text = text.substr(0, text.find_last_not_of(' ', end - 1) + 1);
    if (is_null_word(text)) throw Unfamiliar();
    skip(text.size());
    return Tree::scalar(std::string(text));
  }

  std::shared_ptr<const std::string> file_;
  std::vector<Line> lines_;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<Tree> read_plain_yaml(std::string_view text, const std::shared_ptr<const std::string>& file) {
  const auto is_known = [](char c) { return (c >= ' ' && c <= '~') || c == '\n'; };
  if (text.size() > kMostBytes || !std::all_of(text.begin(), text.end(), is_known)) return std::nullopt;
  try {
    return PlainReader(text, file).read();
  } catch (const Unfamiliar&) {  // no trouble: see above
    return std::nullopt;
  }
}

bool is_plain_word(std::string_view text) {
  return begins_word(text) && text.back() != ' ' && !is_null_word(text) &&
         std::all_of(text.begin(), text.end(), is_of_word);
}

}  // namespace palpate
