// SPDX-License-Identifier: MIT
#include "sweep/condition.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace palpate {

/// A comparison, or others joined.
struct ConditionNode {
  enum class Kind { comparison, all, any, none };
  Kind kind = Kind::comparison;
  std::vector<ConditionNode> parts;  ///< of all, any and none
  std::string name;                  ///< of a comparison, as all below
  std::string sign;
  std::string value;
  bool quoted = false;

  std::string shown() const { return fmt::format("{} {} {}", name, sign, value); }
};

namespace {

using Node = ConditionNode;

constexpr const char* kHowTo = "write it like taps >= 12 and not surface == two_part";
constexpr int kMaxDepth = 100;

/// A word, a quoted text, a sign of comparison or a parenthesis.
struct Token {
  enum class Kind { word, quoted, sign, open, close };
  Kind kind;
  std::string text;
};

bool is_sign(char c) { return std::string_view("=!<>&|").find(c) != std::string_view::npos; }
bool is_space(char c) { return std::string_view(" \t\n\r").find(c) != std::string_view::npos; }
bool ends_word(char c) {
  return is_sign(c) || is_space(c) || std::string_view("()'\"").find(c) != std::string_view::npos;
}

/// What people write who think of another language, and what it is here.
std::string meant_by(const std::string& sign) {
  constexpr std::array<std::array<const char*, 2>, 8> kMeant{{{"=", "=="},
                                                              {"===", "=="},
                                                              {"<>", "!="},
                                                              {"=<", "<="},
                                                              {"=>", ">="},
                                                              {"&&", "and"},
                                                              {"||", "or"},
                                                              {"!", "not"}}};
  const auto found = std::find_if(kMeant.begin(), kMeant.end(), [&](const auto& one) { return one[0] == sign; });
  return found != kMeant.end() ? fmt::format("write '{}'", (*found)[1]) : "known: ==, !=, <, <=, >, >=";
}

/// Reads the text of a condition by descent: or, and, not, comparison.
class Reader {
 public:
  Reader(const std::string& text, std::string place) : text_(text), place_(std::move(place)) { cut(); }

  Node read() {
    if (tokens_.empty()) throw refuse("it is empty");
    Node root = any(0);
    if (next_ < tokens_.size()) {
      const bool closes = tokens_[next_].kind == Token::Kind::close;
      throw refuse(closes ? "a ')' without '('" : fmt::format("'{}' is not expected there", tokens_[next_].text));
    }
    return root;
  }

 private:
  Error refuse(const std::string& reason, const std::string& hint = kHowTo) const {
    constexpr std::size_t kShown = 200;
    const std::string shown = text_.size() <= kShown ? text_ : text_.substr(0, kShown) + "...";
    return Error(place_, fmt::format("the condition '{}': {}", shown, reason), hint);
  }

  void cut() {
    for (std::size_t i = 0; i < text_.size();) {
      const char c = text_[i];
      const std::size_t first = i++;
      if (is_space(c)) continue;
      if (c == '(' || c == ')') {
        tokens_.push_back({c == '(' ? Token::Kind::open : Token::Kind::close, std::string(1, c)});
      } else if (c == '\'' || c == '"') {
        const auto end = text_.find(c, i);
        if (end == std::string::npos) throw refuse("a quote is not closed", "close it");
        tokens_.push_back({Token::Kind::quoted, text_.substr(i, end - i)});
        i = end + 1;
      } else {
        while (i < text_.size() && (is_sign(c) ? is_sign(text_[i]) : !ends_word(text_[i]))) ++i;
        tokens_.push_back({is_sign(c) ? Token::Kind::sign : Token::Kind::word, text_.substr(first, i - first)});
      }
    }
  }

  bool at(Token::Kind kind) const { return next_ < tokens_.size() && tokens_[next_].kind == kind; }

  bool at_word(const char* word) const { return at(Token::Kind::word) && tokens_[next_].text == word; }

  /// Whether a value may go on here: no word of the language.
  bool at_value() const {
    return at(Token::Kind::quoted) || (at(Token::Kind::word) && !at_word("and") && !at_word("or") && !at_word("not"));
  }

  bool take(const char* word) {
    const bool there = at_word(word);
    next_ += there ? 1 : 0;
    return there;
  }

  Node joined(Node::Kind kind, const char* word, Node (Reader::*part)(int), int depth) {
    Node first = (this->*part)(depth);
    if (!at_word(word)) return first;
    Node out;
    out.kind = kind;
    out.parts.push_back(std::move(first));
    while (take(word)) out.parts.push_back((this->*part)(depth));
    return out;
  }

  Node any(int depth) { return joined(Node::Kind::any, "or", &Reader::all, depth); }
  Node all(int depth) { return joined(Node::Kind::all, "and", &Reader::one, depth); }

  Node one(int depth) {
    if (depth > kMaxDepth) throw refuse("nested too deeply", "at most 100 levels");
    if (take("not")) {
      Node out;
      out.kind = Node::Kind::none;
      out.parts.push_back(one(depth + 1));
      return out;
    }
    if (!at(Token::Kind::open)) return comparison();
    ++next_;
    Node out = any(depth + 1);
    if (!at(Token::Kind::close)) throw refuse("a '(' is not closed", "close it");
    ++next_;
    return out;
  }

  Node comparison() {
    if (at(Token::Kind::sign)) {
      throw refuse(fmt::format("'{}' is not expected there", tokens_[next_].text), meant_by(tokens_[next_].text));
    }
    if (!at_value()) throw refuse("a comparison is missing");
    const bool is_name = at(Token::Kind::word) && (tokens_[next_].text[0] < '0' || tokens_[next_].text[0] > '9');
    Node out;
    out.name = tokens_[next_++].text;
    if (!is_name) throw refuse(fmt::format("'{}' is no name", out.name), "write the name first: taps >= 12");
    if (!at(Token::Kind::sign)) throw refuse(fmt::format("behind '{}' a comparison is missing", out.name));
    out.sign = tokens_[next_++].text;
    constexpr std::array<const char*, 6> kSigns{"==", "!=", "<", "<=", ">", ">="};
    if (std::find(kSigns.begin(), kSigns.end(), out.sign) == kSigns.end()) {
      throw refuse(fmt::format("'{}' is no comparison", out.sign), meant_by(out.sign));
    }
    if (!at_value()) throw refuse(fmt::format("behind '{} {}' a value is missing", out.name, out.sign));
    out.quoted = at(Token::Kind::quoted);
    out.value = tokens_[next_++].text;
    // A number and its unit are two words.
    while (!out.quoted && at(Token::Kind::word) && at_value()) out.value += " " + tokens_[next_++].text;
    if (at(Token::Kind::sign)) {
      const std::string& sign = tokens_[next_].text;
      const bool joins = sign[0] == '&' || sign[0] == '|';
      throw refuse(fmt::format("'{}' is not expected there", sign),
                   joins ? meant_by(sign) : "join two comparisons by 'and'");
    }
    return out;
  }

  const std::string& text_;
  std::string place_;
  std::vector<Token> tokens_;
  std::size_t next_ = 0;
};

template <class Number>
bool compare(const Number& left, const std::string& sign, const Number& right) {
  if (sign == "==") return left == right;
  if (sign == "!=") return left != right;
  if (sign == "<") return left < right;
  if (sign == "<=") return left <= right;
  return sign == ">" ? left > right : left >= right;
}

/// Asks a condition; `place` is to blame.
class Asker {
 public:
  Asker(const std::string& place, const Condition::Values& value_of, const std::vector<std::string>& known)
      : place_(place), value_of_(value_of), known_(known) {}

  /// Names that no evaluation may reach are checked all the same.
  void check(const Node& node) const {
    for (const Node& part : node.parts) check(part);
    if (node.kind != Node::Kind::comparison || value_of_(node.name)) return;
    throw Error(place_, fmt::format("in the condition '{}' the name '{}' is not known", node.shown(), node.name),
                suggestion(node.name, known_));
  }

  bool holds(const Node& node) const {
    const auto one = [&](const Node& part) { return holds(part); };
    switch (node.kind) {
      case Node::Kind::all:
        return std::all_of(node.parts.begin(), node.parts.end(), one);
      case Node::Kind::any:
        return std::any_of(node.parts.begin(), node.parts.end(), one);
      case Node::Kind::none:
        return std::none_of(node.parts.begin(), node.parts.end(), one);
      case Node::Kind::comparison:
        break;
    }
    return compares(node);
  }

 private:
  bool compares(const Node& node) const {
    const std::string left = *value_of_(node.name);
    const std::optional<std::string> named = node.quoted ? std::nullopt : value_of_(node.value);
    const std::string right = named.value_or(node.value);
    if (left.empty() || (named && named->empty())) return false;
    const std::optional<AnyQuantity> a = node.quoted ? std::nullopt : any_quantity(left);
    const std::optional<AnyQuantity> b = node.quoted ? std::nullopt : any_quantity(right);
    if (a && b) {
      if (a->unit == b->unit) return compare(a->value, node.sign, b->value);
      throw Error(place_,
                  fmt::format("the condition '{}' compares a {} ('{}') with a {} ('{}')", node.shown(),
                              dimension_name(a->unit), left, dimension_name(b->unit), right),
                  "give both the same dimension");
    }
    if (node.sign == "==" || node.sign == "!=") return compare(left, node.sign, right);
    throw Error(place_, fmt::format("the condition '{}' orders texts: '{}' and '{}'", node.shown(), left, right),
                "texts compare by == and != alone");
  }

  const std::string& place_;
  const Condition::Values& value_of_;
  const std::vector<std::string>& known_;
};

}  // namespace

Condition::Condition(const Tree& text) : place_(text.place.text()) {
  if (!text.is_scalar()) throw Error(place_, "a condition is a text", kHowTo);
  root_ = std::make_unique<const Node>(Reader(text.text, place_).read());
}

Condition::~Condition() = default;
Condition::Condition(Condition&& other) noexcept = default;
Condition& Condition::operator=(Condition&& other) noexcept = default;

bool Condition::holds(const Values& value_of, const std::vector<std::string>& known) const {
  const Asker asker(place_, value_of, known);
  asker.check(*root_);
  return asker.holds(*root_);
}

}  // namespace palpate
