// SPDX-License-Identifier: MIT
#include "sweep/where_condition.hpp"

#include "config/comparison.hpp"
#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

namespace palpate {

namespace {

using Value = WhereCondition::Value;
/// Value of a condition; nullopt means undecided.
using Decision = std::optional<bool>;

constexpr const char* kHowTo = "write it like taps >= 12 and not belief.surface == two_part";
constexpr int kMaxDepth = 100;

bool is_sign(char c) { return std::string_view("=!<>&|").find(c) != std::string_view::npos; }
bool is_space(char c) { return std::string_view(" \t\n\r").find(c) != std::string_view::npos; }
bool is_quote(char c) { return c == '\'' || c == '"'; }
bool ends_word(char c) { return is_sign(c) || is_space(c) || is_quote(c) || c == '(' || c == ')'; }

/// Returns the hint for an operator that other languages use, such as === or &&.
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

/// A recursive-descent parser (or, and, not, comparison) that evaluates the condition while it reads.
class ConditionParser {
 public:
  /// Without `value_of`, only the syntax is checked.
  ConditionParser(const std::string& text, const std::string& place, const WhereCondition::Values& value_of = nullptr,
                  const std::vector<std::string>& known = {})
      : text_(text), place_(place), value_of_(value_of), known_(known) {
    cut();
  }

  Decision read() {
    if (tokens_.empty()) throw refuse("it is empty");
    const Decision out = any(0, true);
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

  /// Returns whether the next token is a value, not a keyword or an operator.
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

  /// Returns the next token without its opening quote.
  std::string shown() const { return tokens_[next_].substr(at_quoted() ? 1 : 0); }

  /// Reads parts that are joined by `word`. If a part has the value `decides`, this is the result, and the remaining
  /// parts are only parsed. Otherwise, the result is undecided if a part is undecided.
  Decision joined(bool decides, const char* word, Decision (ConditionParser::*part)(int, bool), int depth, bool asked) {
    Decision out = (this->*part)(depth, asked);
    while (take(word)) {
      const Decision next = (this->*part)(depth, asked && out != decides);
      if (out != decides && next != !decides) out = next;
    }
    return out;
  }

  Decision any(int depth, bool asked) { return joined(true, "or", &ConditionParser::all, depth, asked); }
  Decision all(int depth, bool asked) { return joined(false, "and", &ConditionParser::one, depth, asked); }

  Decision one(int depth, bool asked) {
    if (depth > kMaxDepth) throw refuse("nested too deeply", "at most 100 levels");
    if (take("not")) {
      const Decision inner = one(depth + 1, asked);
      return inner ? Decision(!*inner) : inner;
    }
    if (!take("(")) return comparison(asked);
    const Decision out = any(depth + 1, asked);
    if (!take(")")) throw refuse("a '(' is not closed", "close it");
    return out;
  }

  Decision comparison(bool asked) {
    if (at_sign()) throw refuse(fmt::format("'{}' is not expected here", shown()), meant_by(shown()));
    if (!at_value()) throw refuse("a comparison is missing");
    const std::string name = shown();
    if (at_quoted() || (name[0] >= '0' && name[0] <= '9'))
      throw refuse(fmt::format("'{}' is not a name", name), "write the name first: taps >= 12");
    ++next_;
    if (!at_sign()) throw refuse(fmt::format("a comparison is missing after '{}'", name));
    const std::string sign = tokens_[next_++];
    const std::optional<Relation> relation = relation_of(sign);
    if (!relation) throw refuse(fmt::format("'{}' is not a comparison", sign), meant_by(sign));
    if (!at_value()) throw refuse(fmt::format("a value is missing after '{} {}'", name, sign));
    const bool quoted = at_quoted();
    std::string value = shown();
    ++next_;
    // A number and its unit are two tokens.
    while (!quoted && !at_quoted() && at_value()) value += " " + tokens_[next_++];
    if (at_sign()) {
      const bool joins = shown()[0] == '&' || shown()[0] == '|';
      throw refuse(fmt::format("'{}' is not expected here", shown()),
                   joins ? meant_by(shown()) : "join two comparisons by 'and'");
    }
    if (!value_of_) return std::nullopt;
    const std::string written = fmt::format("{} {} {}", name, sign, value);
    const std::optional<Value> left = value_of_(name);
    // An unknown name is an error even if its value cannot change the result.
    if (!left)
      throw Error(place_, fmt::format("the condition '{}' has the unknown name '{}'", written, name),
                  suggestion(name, known_));
    return asked ? decide(*left, *relation, value, quoted, written) : std::nullopt;
  }

  Decision decide(const Value& left, Relation relation, const std::string& value, bool quoted,
                  const std::string& written) const {
    const Value right = quoted ? Value{value} : value_of_(value).value_or(Value{value});
    // An unquoted value is never empty. An empty right side without quotes is therefore a name without a value.
    const bool lacks_right = right.text.empty() && !quoted;
    if ((left.text.empty() && left.is_result) || (lacks_right && right.is_result)) return std::nullopt;
    if (left.text.empty() || lacks_right) return false;
    const std::optional<AnyQuantity> a = quoted ? std::nullopt : any_quantity(left.text);
    const std::optional<AnyQuantity> b = quoted ? std::nullopt : any_quantity(right.text);
    if (a && b) {
      if (a->unit == b->unit) return satisfies(a->value, relation, b->value);
      throw Error(place_,
                  fmt::format("the condition '{}' compares a {} ('{}') with a {} ('{}')", written,
                              dimension_name(a->unit), left.text, dimension_name(b->unit), right.text),
                  "give both the same dimension");
    }
    if (relation == Relation::equal) return left.text == right.text;
    if (relation == Relation::unequal) return left.text != right.text;
    throw Error(
        place_,
        fmt::format("the condition '{}' compares the order of texts: '{}' and '{}'", written, left.text, right.text),
        "compare texts with == or !=");
  }

  const std::string& text_;
  const std::string& place_;
  const WhereCondition::Values& value_of_;
  const std::vector<std::string>& known_;
  std::vector<std::string> tokens_;  ///< words, operators, parentheses, and quoted texts with their opening quote
  std::size_t next_ = 0;
};

}  // namespace

WhereCondition::WhereCondition(const Tree& text) : place_(text.place.text()), text_(text.text) {
  if (!text.is_scalar()) throw Error(place_, "a condition is a text", kHowTo);
  ConditionParser(text_, place_).read();
}

std::optional<WhereCondition> WhereCondition::of_command_line(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  Tree tree = Tree::scalar(*text, true);
  tree.place.file = std::make_shared<const std::string>("command line: --where");
  return WhereCondition(tree);
}

bool WhereCondition::holds(const Values& value_of, const std::vector<std::string>& known) const {
  return ConditionParser(text_, place_, value_of, known).read() == true;
}

}  // namespace palpate
