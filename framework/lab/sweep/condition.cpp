// SPDX-License-Identifier: MIT
#include "sweep/condition.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace palpate {

namespace {

using Formula = Condition::Formula;

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
  Reader(const std::string& text, std::string place, Condition::Comparisons& comparisons)
      : text_(text), place_(std::move(place)), comparisons_(comparisons) {
    cut();
  }

  Formula read() {
    if (tokens_.empty()) throw refuse("it is empty");
    Formula out = any(0);
    if (next_ < tokens_.size()) {
      const bool closes = tokens_[next_].kind == Token::Kind::close;
      throw refuse(closes ? "a ')' without '('" : fmt::format("'{}' is not expected there", tokens_[next_].text));
    }
    return out;
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

  /// Parts with `word` between them: one that comes out as `decides` decides for all.
  Formula joined(bool decides, const char* word, Formula (Reader::*part)(int), int depth) {
    std::vector<Formula> parts{(this->*part)(depth)};
    while (take(word)) parts.push_back((this->*part)(depth));
    if (parts.size() == 1) return parts.front();
    return [decides, parts = std::move(parts)](const auto& holds) {
      const bool any =
          std::any_of(parts.begin(), parts.end(), [&](const Formula& one) { return one(holds) == decides; });
      return any == decides;
    };
  }

  Formula any(int depth) { return joined(true, "or", &Reader::all, depth); }
  Formula all(int depth) { return joined(false, "and", &Reader::one, depth); }

  Formula one(int depth) {
    if (depth > kMaxDepth) throw refuse("nested too deeply", "at most 100 levels");
    if (take("not")) {
      return [inner = one(depth + 1)](const auto& holds) { return !inner(holds); };
    }
    if (!at(Token::Kind::open)) return comparison();
    ++next_;
    Formula out = any(depth + 1);
    if (!at(Token::Kind::close)) throw refuse("a '(' is not closed", "close it");
    ++next_;
    return out;
  }

  Formula comparison() {
    if (at(Token::Kind::sign)) {
      throw refuse(fmt::format("'{}' is not expected there", tokens_[next_].text), meant_by(tokens_[next_].text));
    }
    if (!at_value()) throw refuse("a comparison is missing");
    const bool is_name = at(Token::Kind::word) && (tokens_[next_].text[0] < '0' || tokens_[next_].text[0] > '9');
    Condition::Comparison out;
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
    comparisons_.push_back(std::move(out));
    return [number = comparisons_.size() - 1](const auto& holds) { return holds(number); };
  }

  const std::string& text_;
  std::string place_;
  Condition::Comparisons& comparisons_;
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

}  // namespace

Condition::Condition(const Tree& text) : place_(text.place.text()) {
  if (!text.is_scalar()) throw Error(place_, "a condition is a text", kHowTo);
  formula_ = Reader(text.text, place_, comparisons_).read();
}

bool Condition::holds(const Values& value_of, const std::vector<std::string>& known) const {
  // Names that no evaluation may reach are checked all the same.
  for (const Comparison& one : comparisons_) {
    if (value_of(one.name)) continue;
    throw Error(place_, fmt::format("in the condition '{}' the name '{}' is not known", one.shown(), one.name),
                suggestion(one.name, known));
  }
  return formula_([&](std::size_t number) { return holds(comparisons_[number], value_of); });
}

bool Condition::holds(const Comparison& comparison, const Values& value_of) const {
  const auto& [name, sign, value, quoted] = comparison;
  const std::string left = *value_of(name);
  const std::string right = quoted ? value : value_of(value).value_or(value);
  // A value as it is written is never empty unless it is quoted: who has none is a name.
  if (left.empty() || (right.empty() && !quoted)) return false;
  const std::optional<AnyQuantity> a = quoted ? std::nullopt : any_quantity(left);
  const std::optional<AnyQuantity> b = quoted ? std::nullopt : any_quantity(right);
  if (a && b) {
    if (a->unit == b->unit) return compare(a->value, sign, b->value);
    throw Error(place_,
                fmt::format("the condition '{}' compares a {} ('{}') with a {} ('{}')", comparison.shown(),
                            dimension_name(a->unit), left, dimension_name(b->unit), right),
                "give both the same dimension");
  }
  if (sign == "==" || sign == "!=") return compare(left, sign, right);
  throw Error(place_, fmt::format("the condition '{}' orders texts: '{}' and '{}'", comparison.shown(), left, right),
              "texts compare by == and != alone");
}

}  // namespace palpate
