// SPDX-License-Identifier: MIT
#include "sweep/condition.hpp"

#include "config/quantity.hpp"
#include "config/relation.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

namespace palpate {

namespace {

using Formula = Condition::Formula;
using Logical = Condition::Logical;

constexpr const char* kHowTo = "write it like taps >= 12 and not surface == two_part";
constexpr int kMaxDepth = 100;

bool is_sign(char c) { return std::string_view("=!<>&|").find(c) != std::string_view::npos; }
bool is_space(char c) { return std::string_view(" \t\n\r").find(c) != std::string_view::npos; }
bool is_quote(char c) { return c == '\'' || c == '"'; }
bool ends_word(char c) { return is_sign(c) || is_space(c) || is_quote(c) || c == '(' || c == ')'; }

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

Logical negation(Logical truth) {
  if (truth == Logical::undecided) return truth;
  return truth == Logical::yes ? Logical::no : Logical::yes;
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
    if (at(")")) throw refuse("there is a ')' without a '('");
    if (next_ < tokens_.size()) throw refuse(fmt::format("'{}' is not expected here", shown()));
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
      if (is_quote(c)) {
        const auto end = text_.find(c, i);
        if (end == std::string::npos) throw refuse("a quote is not closed", "close it");
        tokens_.push_back(text_.substr(first, end - first));
        i = end + 1;
      } else {
        const bool alone = c == '(' || c == ')';
        while (!alone && i < text_.size() && (is_sign(c) ? is_sign(text_[i]) : !ends_word(text_[i]))) ++i;
        tokens_.push_back(text_.substr(first, i - first));
      }
    }
  }

  bool at(const char* token) const { return next_ < tokens_.size() && tokens_[next_] == token; }
  bool at_sign() const { return next_ < tokens_.size() && is_sign(tokens_[next_].front()); }
  bool at_quoted() const { return next_ < tokens_.size() && is_quote(tokens_[next_].front()); }

  /// Whether a value may go on here: no word of the language.
  bool at_value() const {
    constexpr std::array<const char*, 5> kOthers{"and", "or", "not", "(", ")"};
    return next_ < tokens_.size() && !at_sign() &&
           std::none_of(kOthers.begin(), kOthers.end(), [&](const char* one) { return at(one); });
  }

  bool take(const char* token) {
    const bool there = at(token);
    next_ += there ? 1 : 0;
    return there;
  }

  /// The next token as it is read: of a quoted text what stands in the quotes.
  std::string shown() const { return tokens_[next_].substr(at_quoted() ? 1 : 0); }

  /// Parts with `word` between them: one that comes out as `decides` decides for all, else one that is undecided does.
  Formula joined(Logical decides, const char* word, Formula (Reader::*part)(int), int depth) {
    std::vector<Formula> parts{(this->*part)(depth)};
    while (take(word)) parts.push_back((this->*part)(depth));
    if (parts.size() == 1) return parts.front();
    return [decides, parts = std::move(parts)](const auto& decide) {
      Logical out = negation(decides);
      for (const Formula& one : parts) {
        const Logical truth = one(decide);
        if (truth == decides) return decides;
        if (truth == Logical::undecided) out = truth;
      }
      return out;
    };
  }

  Formula any(int depth) { return joined(Logical::yes, "or", &Reader::all, depth); }
  Formula all(int depth) { return joined(Logical::no, "and", &Reader::one, depth); }

  Formula one(int depth) {
    if (depth > kMaxDepth) throw refuse("nested too deeply", "at most 100 levels");
    if (take("not")) {
      return [inner = one(depth + 1)](const auto& decide) { return negation(inner(decide)); };
    }
    if (!take("(")) return comparison();
    Formula out = any(depth + 1);
    if (!take(")")) throw refuse("a '(' is not closed", "close it");
    return out;
  }

  Formula comparison() {
    if (at_sign()) throw refuse(fmt::format("'{}' is not expected here", shown()), meant_by(shown()));
    if (!at_value()) throw refuse("a comparison is missing");
    Condition::Comparison out;
    out.name = shown();
    if (at_quoted() || (out.name[0] >= '0' && out.name[0] <= '9'))
      throw refuse(fmt::format("'{}' is not a name", out.name), "write the name first: taps >= 12");
    ++next_;
    if (!at_sign()) throw refuse(fmt::format("a comparison is missing after '{}'", out.name));
    out.sign = tokens_[next_++];
    if (!relation_of(out.sign)) throw refuse(fmt::format("'{}' is not a comparison", out.sign), meant_by(out.sign));
    if (!at_value()) throw refuse(fmt::format("a value is missing after '{} {}'", out.name, out.sign));
    out.quoted = at_quoted();
    out.value = shown();
    ++next_;
    // A number and its unit are two words.
    while (!out.quoted && !at_quoted() && at_value()) out.value += " " + tokens_[next_++];
    if (at_sign()) {
      const bool joins = shown()[0] == '&' || shown()[0] == '|';
      throw refuse(fmt::format("'{}' is not expected here", shown()),
                   joins ? meant_by(shown()) : "join two comparisons by 'and'");
    }
    comparisons_.push_back(std::move(out));
    return [number = comparisons_.size() - 1](const auto& decide) { return decide(number); };
  }

  const std::string& text_;
  std::string place_;
  Condition::Comparisons& comparisons_;
  std::vector<std::string> tokens_;  ///< a word, a sign, a parenthesis, or a quoted text behind its first quote
  std::size_t next_ = 0;
};

Logical decided(bool holds) { return holds ? Logical::yes : Logical::no; }

}  // namespace

Condition::Condition(const Tree& text) : place_(text.place.text()) {
  if (!text.is_scalar()) throw Error(place_, "a condition is a text", kHowTo);
  formula_ = Reader(text.text, place_, comparisons_).read();
}

Condition Condition::of_command_line(const std::string& text) {
  Tree tree = Tree::scalar(text, true);
  tree.place.file = std::make_shared<const std::string>("command line: --where");
  return Condition(tree);
}

bool Condition::holds(const Values& value_of, const std::vector<std::string>& known) const {
  // Names that no evaluation may reach are checked all the same.
  for (const Comparison& one : comparisons_) {
    if (value_of(one.name)) continue;
    throw Error(place_, fmt::format("the condition '{}' has the unknown name '{}'", one.shown(), one.name),
                suggestion(one.name, known));
  }
  return formula_([&](std::size_t number) { return decide(comparisons_[number], value_of); }) == Logical::yes;
}

Condition::Logical Condition::decide(const Comparison& comparison, const Values& value_of) const {
  const auto& [name, sign, value, quoted] = comparison;
  const Value left = *value_of(name);
  const Value right = quoted ? Value{value} : value_of(value).value_or(Value{value});
  // A value as it is written is never empty unless it is quoted: who has none is a name.
  const bool lacks_right = right.text.empty() && !quoted;
  if ((left.text.empty() && left.is_result) || (lacks_right && right.is_result)) return Logical::undecided;
  if (left.text.empty() || lacks_right) return Logical::no;
  const std::optional<AnyQuantity> a = quoted ? std::nullopt : any_quantity(left.text);
  const std::optional<AnyQuantity> b = quoted ? std::nullopt : any_quantity(right.text);
  if (a && b) {
    if (a->unit == b->unit) return decided(satisfies(a->value, relation_of(sign).value(), b->value));
    throw Error(place_,
                fmt::format("the condition '{}' compares a {} ('{}') with a {} ('{}')", comparison.shown(),
                            dimension_name(a->unit), left.text, dimension_name(b->unit), right.text),
                "give both the same dimension");
  }
  if (sign == sign_of(Relation::equal)) return decided(left.text == right.text);
  if (sign == sign_of(Relation::unequal)) return decided(left.text != right.text);
  throw Error(place_,
              fmt::format("the condition '{}' compares the order of texts: '{}' and '{}'", comparison.shown(),
                          left.text, right.text),
              "compare texts with == or !=");
}

}  // namespace palpate
