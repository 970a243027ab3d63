// SPDX-License-Identifier: MIT
#include "config/expand.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/trim.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t kMaxValues = 1'000'000;        ///< limit per axis
constexpr std::size_t kMostValues = 2 * kMaxValues;  ///< limit for all axes together
constexpr const char* kHowTo = "write range(0,10), range(0,10,2) or logspace(1cm,5cm,8), both ends with the same unit";

[[noreturn]] void refuse(const Tree& tree, const std::string& key, const std::string& reason, const std::string& hint) {
  throw Error(tree.place.text(), fmt::format("{}: '{}' {}", key, tree.text, reason), hint);
}

/// Splits at commas outside of brackets and quotes.
std::vector<std::string> split_top(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '[' || c == '{') {
      ++depth;
    } else if (c == ')' || c == ']' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  return parts;
}

Bound parse_bound(const std::string& text, const Tree& tree, const std::string& key, const std::string& how_to) {
  Bound out{0.0, {}};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), out.value);
  if (result.ec != std::errc() || !std::isfinite(out.value))
    throw Error(tree.place.text(), fmt::format("{}: '{}' in '{}' is not a number", key, text, tree.text), how_to);
  out.unit = boost::trim_copy(std::string(result.ptr, text.data() + text.size()));
  return out;
}

constexpr double kRounding = 1e-9;

/// Rounds to 15 digits, which removes rounding errors of steps: 3 * 0.1 is 0.30000000000000004 and becomes 0.3.
double as_decimal(double value) { return std::abs(value) < 1e15 ? rounded(value, 15) : value; }

std::vector<Tree> expand_range(const std::vector<Bound>& from, const Tree& tree, const std::string& key,
                               ValueCount& counted) {
  const double step = from.size() == 3 ? from[2].value : 1.0;
  // kRounding prevents rounding errors from including the end of a range: (1.3 - 1) / 0.1 is 3.0000000000000004.
  const double count = std::ceil((from[1].value - from[0].value) / step - kRounding);
  if (!(count >= 1.0)) refuse(tree, key, "has no value", "the end must lie beyond the start");
  if (count > static_cast<double>(kMaxValues)) refuse(tree, key, "has more than a million values", "use a wider step");
  counted.add(static_cast<std::size_t>(count), tree.place, key);
  std::vector<Tree> out;
  for (int i = 0; i < static_cast<int>(count); ++i)
    out.push_back(number(as_decimal(from[0].value + i * step), from[0].unit, tree));
  return out;
}

std::vector<Tree> expand_logspace(const std::vector<Bound>& from, const Tree& tree, const std::string& key,
                                  ValueCount& counted) {
  const double first = from[0].value;
  const double last = from[1].value;
  const double count = from[2].value;
  if (!(first > 0.0) || !(last > 0.0) || count < 2.0 || count != std::floor(count) || count > 10000.0)
    refuse(tree, key, "needs two positive ends and a count of 2 to 10000", kHowTo);
  counted.add(static_cast<std::size_t>(count), tree.place, key);
  std::vector<Tree> out;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double share = i / (count - 1.0);
    // The first and the last value are exactly as written. Rounding errors of the values between them do not matter.
    const double value = i == 0 ? first : share == 1.0 ? last : first * math::pow(last / first, share);
    out.push_back(number(value, from[0].unit, tree));
  }
  return out;
}

}  // namespace

std::optional<RangeCall> parse_call(const Tree& value, const std::string& key, const std::vector<std::string>& names,
                                    const std::string& how_to) {
  const auto open = value.text.find('(');
  if (!value.is_scalar() || open == std::string::npos) return std::nullopt;
  RangeCall call{value.text.substr(0, open), {}};
  if (std::find(names.begin(), names.end(), call.name) == names.end()) return std::nullopt;
  if (value.text.back() != ')')
    refuse(value, key, "has no closing ')'", fmt::format("inside braces, put it into quotes: \"{}(...)\"", call.name));
  for (const std::string& part : split_top(value.text.substr(open + 1, value.text.size() - open - 2)))
    call.bounds.push_back(parse_bound(boost::trim_copy(part), value, key, how_to));
  return call;
}

double ContinuousRange::at(double share) const {
  if (share == 1.0) return last;
  return logarithmic ? first * math::pow(last / first, share) : first + share * (last - first);
}

std::optional<ContinuousRange> parse_continuous(const Tree& value, const std::string& key) {
  const std::optional<RangeCall> call = parse_call(value, key, {"uniform", "log_uniform"}, kContinuousHint);
  if (!call) return std::nullopt;
  std::vector<Bound> ends = call->bounds;
  if (ends.size() != 2) refuse(value, key, "does not have two ends", kContinuousHint);
  if (ends[0].unit != ends[1].unit) {
    const auto one = any_quantity("1 " + ends[0].unit);
    const auto last = any_quantity(fmt::format("{} {}", ends[1].value, ends[1].unit));
    if (!one || !last || one->unit != last->unit)
      refuse(value, key, "has ends with units of different dimensions", kContinuousHint);
    ends[1] = {as_decimal(last->value / one->value), ends[0].unit};
  }
  const ContinuousRange range{call->name == "log_uniform", ends[0].value, ends[1].value, ends[0].unit};
  if (range.logarithmic && !(range.first > 0.0)) refuse(value, key, "is not above 0", "both ends must be");
  if (!(range.first < range.last) || !std::isfinite(range.last - range.first))
    refuse(value, key, "is not a range", "the first end must be below the last");
  return range;
}

double rounded(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Tree number(double value, const std::string& unit, const Tree& like) {
  Tree out = like;
  out.quoted = false;
  out.text = fmt::format("{}", value) + (unit.empty() ? "" : " " + unit);
  return out;
}

void ValueCount::add(std::size_t values, const SourceLocation& place, const std::string& key) {
  all_ += values;
  if (all_ <= kMostValues) return;
  throw Error(place.text(), fmt::format("{}: the sweep names more than two million values", key), "use fewer values");
}

std::vector<Tree> expand_values(const Tree& value, const std::string& key, ValueCount& count) {
  if (value.kind == Tree::Kind::list) {
    if (value.items.empty())
      throw Error(value.place.text(), fmt::format("{}: the list of values is empty", key), "write [value, value]");
    count.add(value.items.size(), value.place, key);
    return value.items;
  }
  if (value.kind == Tree::Kind::null)
    throw Error(value.place.text(), fmt::format("{}: has no value", key), "write [value, value]");
  const std::optional<RangeCall> call = parse_call(value, key, {"range", "logspace"}, kHowTo);
  if (!call) return count.add(1, value.place, key), std::vector<Tree>{value};
  const std::vector<Bound>& parts = call->bounds;
  const bool is_range = call->name == "range";
  const bool right_count = is_range ? parts.size() == 2 || parts.size() == 3 : parts.size() == 3;
  const bool same_unit = right_count && parts[0].unit == parts[1].unit &&
                         (parts.size() < 3 || parts[2].unit == (is_range ? parts[0].unit : std::string()));
  if (!same_unit) refuse(value, key, "is not understood", kHowTo);
  return is_range ? expand_range(parts, value, key, count) : expand_logspace(parts, value, key, count);
}

SweepAxis parse_axis(const std::string& text, ValueCount& count) {
  Override whole = parse_override(text);
  const std::string value = text.substr(text.find('=') + 1);
  const std::vector<std::string> parts = split_top(value);
  if (parts.size() == 1) return {whole.path, expand_values(whole.value, whole.path, count), whole.value};
  SweepAxis axis{whole.path, {}, Tree::list()};
  for (const std::string& part : parts) {
    const Override one = parse_override(whole.path + "=" + boost::trim_copy(part));
    // If there are several parts, a part that is a list is one value: at=[1cm,1cm],[2cm,2cm].
    if (one.value.kind == Tree::Kind::list) {
      axis.values.push_back(one.value);
      continue;
    }
    for (Tree& tree : expand_values(one.value, whole.path, count)) axis.values.push_back(std::move(tree));
  }
  axis.written.items = axis.values;
  axis.written.place = axis.values.front().place;
  return axis;
}

std::string value_text(const Tree& value) {
  if (value.is_scalar()) return value.text;
  if (value.kind == Tree::Kind::null) return "~";
  std::string out;
  for (const Tree& item : value.items) out += (out.empty() ? "" : ", ") + value_text(item);
  for (const Tree::Entry& entry : value.entries)
    out += (out.empty() ? "" : ", ") + entry.key + ": " + value_text(entry.value);
  return value.is_map() ? "{" + out + "}" : "[" + out + "]";
}

}  // namespace palpate
