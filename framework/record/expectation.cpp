// SPDX-License-Identifier: MIT
#include "record/expectation.hpp"

#include "config/quantity.hpp"
#include "record/fields.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/trim.hpp>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

using Statistic = Expectation::Statistic;

struct StatisticName {
  const char* name;
  Statistic statistic;
  double share;
};
constexpr std::array kStatistics{
    StatisticName{"mean", Statistic::mean, 0.0},     StatisticName{"median", Statistic::quantile, 0.5},
    StatisticName{"min", Statistic::quantile, 0.0},  StatisticName{"max", Statistic::quantile, 1.0},
    StatisticName{"p5", Statistic::quantile, 0.05},  StatisticName{"p10", Statistic::quantile, 0.1},
    StatisticName{"p25", Statistic::quantile, 0.25}, StatisticName{"p75", Statistic::quantile, 0.75},
    StatisticName{"p90", Statistic::quantile, 0.9},  StatisticName{"p95", Statistic::quantile, 0.95},
};

/// A key with its value; the keys of nested maps are joined by dots.
struct Clause {
  std::string key;
  SourceLocation place;
  const Tree* value;
};

std::string without_spaces(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\t'; }), text.end());
  return text;
}

/// Returns the source location of the key. If another source set the value, such as an override, returns the location
/// of the value.
SourceLocation place_of(const Tree::Entry& entry) {
  const SourceLocation& value = entry.value.place;
  return value.file && (!entry.place.file || *value.file != *entry.place.file) ? value : entry.place;
}

void collect(const Tree& map, const std::string& prefix, std::vector<Clause>& lines) {
  for (const Tree::Entry& entry : map.entries) {
    const std::string key = without_spaces(prefix + entry.key);
    if (entry.value.is_map() && !entry.value.entries.empty()) {
      collect(entry.value, key + ".", lines);
      continue;
    }
    const auto twin = std::find_if(lines.begin(), lines.end(), [&](const Clause& line) { return line.key == key; });
    if (twin != lines.end()) throw Error(place_of(entry).text(), fmt::format("expect.{}: is given twice", key));
    lines.push_back({key, place_of(entry), &entry.value});
  }
}

std::vector<Clause> lines_of(const Tree& expect) {
  std::vector<Clause> lines;
  if (!expect.is_map() && expect.kind != Tree::Kind::null)
    throw Error(expect.place.text(), "expect: is not a map of expectations",
                "write expect: {object_taps: \">= 9\", rmse_m: \"<= 2 cm\"}");
  collect(expect, "", lines);
  return lines;
}

std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for (const RecordField& field : summary_fields()) names.push_back(field.name);
  names.emplace_back(kFailedRuns);
  return names;
}

/// Splits the key into statistic and field. Throws Error for unknown names.
const RecordField& read_key(const Clause& line, Expectation& out) {
  static const RecordField failed_runs = RecordField(kFailedRuns, "runs that failed").less();
  out.key = out.field = line.key;
  const auto open = line.key.find('(');
  if (open != std::string::npos) {
    if (line.key.back() != ')' || line.key.find('(', open + 1) != std::string::npos)
      throw Error(line.place.text(), fmt::format("expect: '{}' is not a field or STATISTIC(field)", line.key),
                  "write it like median(object_taps)");
    const std::string name = line.key.substr(0, open);
    out.field = line.key.substr(open + 1, line.key.size() - open - 2);
    const auto found = std::find_if(kStatistics.begin(), kStatistics.end(),
                                    [&](const StatisticName& one) { return one.name == name; });
    if (found == kStatistics.end())
      throw Error(line.place.text(), fmt::format("expect: unknown statistic '{}'", name),
                  suggestion(name, statistic_names()));
    out.statistic = found->statistic;
    out.share = found->share;
  }
  const bool counts = out.field == kFailedRuns;
  const RecordField* field = counts ? &failed_runs : find_summary_field(out.field);
  if (field == nullptr)
    throw Error(line.place.text(), fmt::format("expect: the summary has no field '{}'", out.field),
                suggestion(out.field, field_names()));
  if (out.statistic != Statistic::each && (counts || field->type == RecordField::Type::text))
    throw Error(line.place.text(), fmt::format("expect: '{}' has no statistics", out.field),
                fmt::format("write {} alone", out.field));
  return *field;
}

std::string example(const RecordField& field, Statistic statistic) {
  if (field.type == RecordField::Type::text) return "write the expected text";
  if (field.type == RecordField::Type::flag && statistic == Statistic::each) return "write true or false";
  if (field.unit == Unit::metre) return "write a comparison like '<= 2 cm'";
  if (field.unit == Unit::second) return "write a comparison like '<= 90 s'";
  return "write a comparison like '>= 9', with >=, <=, >, < or ==";
}

Expectation read_comparison(const RecordField& field, Expectation out, const Tree& value) {
  const std::string name = "expect." + out.key;
  const auto refuse = [&](const std::string& reason) {
    throw Error(value.place.text(), name + ": " + reason, example(field, out.statistic));
  };
  if (value.kind == Tree::Kind::null) refuse("has no value");
  if (!value.is_scalar()) refuse("is not a comparison");
  if (value.text.empty()) refuse("has no value (one that begins with > needs quotes)");
  const std::string& written = value.text;
  const std::string leading = written.substr(0, written.find_first_not_of("<=>"));
  const std::optional<Relation> sign = relation_of(leading);
  Tree rest = value;
  if (sign) {
    rest.text = boost::trim_left_copy(written.substr(leading.size()));
    out.comparison = *sign;
  }
  out.wanted = fmt::format("{} {}", sign_of(out.comparison), rest.text);
  const bool is_flag = field.type == RecordField::Type::flag && out.statistic == Statistic::each;
  if (is_flag || field.type == RecordField::Type::text) {
    if (out.comparison != Relation::equal)
      refuse(fmt::format("'{}' does not compare with {}", written, sign_of(*sign)));
    if (is_flag && rest.text != "true" && rest.text != "false")
      refuse(fmt::format("'{}' is not a truth value", rest.text));
    out.bound = rest.text == "true" ? 1.0 : 0.0;
    out.text = rest.text;
    return out;
  }
  if (!sign) refuse(fmt::format("'{}' has no comparison", written));
  rest.place = value.place;
  out.bound = read_quantity(rest, name, field.unit);
  out.unit = boost::trim_copy(rest.text.substr(decimal_length(rest.text)));
  return out;
}

}  // namespace

std::vector<std::string> statistic_names() {
  std::vector<std::string> names;
  for (const StatisticName& one : kStatistics) names.emplace_back(one.name);
  return names;
}

std::vector<Expectation> read_expectations(const Tree* expect) {
  std::vector<Expectation> out;
  if (expect == nullptr) return out;
  for (const Clause& line : lines_of(*expect)) {
    Expectation one;
    const RecordField& field = read_key(line, one);
    one.place = line.place.text();
    const bool several = line.value->kind == Tree::Kind::list;
    if (several && line.value->items.empty())
      throw Error(line.place.text(), fmt::format("expect.{}: the list is empty", one.key),
                  example(field, one.statistic));
    if (!several) out.push_back(read_comparison(field, one, *line.value));
    for (const Tree& item : line.value->items) out.push_back(read_comparison(field, one, item));
  }
  return out;
}

Tree resolved_expect(const Tree& expect, ResolveNotes& notes) {
  Tree out = Tree::map();
  for (const Clause& line : lines_of(expect)) {
    Tree value = *line.value;
    value.quoted = value.is_scalar();
    for (Tree& item : value.items) item.quoted = true;
    notes.origins.push_back({"expect." + line.key, line.place.text()});
    out.entries.push_back({line.key, line.place, std::move(value)});
  }
  return out;
}

}  // namespace palpate
