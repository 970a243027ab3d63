// SPDX-License-Identifier: MIT
#include "record/gate.hpp"

#include "config/display_units.hpp"
#include "config/quantity.hpp"
#include "reading/read_file.hpp"
#include "record/fields.hpp"
#include "record/quantiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

namespace palpate {
namespace {

using Statistic = Expectation::Statistic;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool wants_more(Relation relation) { return relation == Relation::at_least || relation == Relation::above; }

/// Returns the number or flag `field` of the summary; nullopt if it is null, missing or not finite, or if the run
/// failed.
std::optional<double> number_at(const RunOutcome& run, const std::string& field) {
  return run.summary && run.failure.empty() ? run.summary->number(field) : std::nullopt;
}

/// Returns the value in the unit of the bound, with enough digits to distinguish value and bound.
std::string shown(const Expectation& one, double value) {
  const RecordField* field = find_summary_field(one.field);
  if (field != nullptr && field->type == RecordField::Type::flag && one.statistic == Statistic::each)
    return value != 0.0 ? "true" : "false";
  const double scale =
      one.unit.empty() ? 1.0 : read_quantity(Tree::scalar("1 " + one.unit), one.key, unit_of_column(one.field));
  const std::string unit = one.unit.empty() ? "" : " " + one.unit;
  constexpr int kAll = 17;
  int digits = 4;
  while (digits < kAll && value != one.bound &&
         significant(value / scale, digits) == significant(one.bound / scale, digits))
    ++digits;
  return significant(value / scale, digits) + unit;
}

/// Returns the reason why a run has no value.
std::string absence(const Expectation& one, const RunOutcome& run) {
  if (!run.failure.empty()) return "the run failed";
  const Scalar* value = run.summary ? run.summary->find(one.field) : nullptr;
  if (value != nullptr && std::holds_alternative<double>(*value)) return fmt::format("{} is not finite", one.field);
  const RecordField* field = find_summary_field(one.field);
  const std::string reason = field != nullptr ? field->when_null : std::string();
  return reason.empty() ? fmt::format("the summary has no {}", one.field) : reason;
}

/// Compares a field of one run's summary with the expectation.
ExpectationResult judge_run(const Expectation& one, const RunOutcome& run) {
  const RecordField* field = find_summary_field(one.field);
  if (field != nullptr && field->type == RecordField::Type::text) {
    const std::string text = run.summary ? run.summary->text(one.field) : std::string();
    if (text.empty()) return {one, false, "no value: " + absence(one, run)};
    return {one, text == one.text, text};
  }
  const std::optional<double> value = number_at(run, one.field);
  if (!value) return {one, false, "no value: " + absence(one, run)};
  return {one, satisfies(value, one.comparison, one.bound), shown(one, *value)};
}

/// Checks each run separately. The result names the first run that does not meet the expectation, and the number of all
/// runs that do not meet it.
ExpectationResult judge_each(const Expectation& one, const std::vector<RunOutcome>& runs) {
  int missed = 0;
  std::string got;
  for (const RunOutcome& run : runs) {
    ExpectationResult verdict = judge_run(one, run);
    if (runs.size() == 1) return verdict;
    if (verdict.holds) continue;
    if (missed++ == 0) got = fmt::format("{} in {}", verdict.got, run.label);
  }
  if (missed > 1) got += fmt::format(", and {} of {} runs miss the expectation", missed, runs.size());
  return {one, missed == 0, got};
}

double statistic_of(const Expectation& one, const std::vector<double>& sorted) {
  if (one.statistic == Statistic::quantile) return quantile(sorted, one.share);
  // If a value is infinite, the mean is infinite. mean_of() requires finite values.
  if (!std::isfinite(sorted.front())) return sorted.front();
  if (!std::isfinite(sorted.back())) return sorted.back();
  return mean_of(sorted);
}

/// Returns a text such as " over 20 seeds"; "" if all runs have the same seed.
std::string seeds_words(const std::vector<RunOutcome>& runs) {
  std::set<std::optional<std::string>> seeds;
  for (const RunOutcome& run : runs) seeds.insert(run.seed);
  return seeds.size() > 1 ? fmt::format(" over {} seeds", seeds.size()) : std::string();
}

/// Checks a statistic over all runs. A run without a value counts as the worst possible value. For `==`, the
/// expectation must hold both with -infinity and with +infinity in place of missing values.
ExpectationResult judge_statistic(const Expectation& one, const std::vector<RunOutcome>& runs) {
  std::vector<double> values;
  std::vector<const RunOutcome*> without;
  for (const RunOutcome& run : runs) {
    if (const std::optional<double> value = number_at(run, one.field)) {
      values.push_back(*value);
    } else {
      without.push_back(&run);
    }
  }
  if (without.size() == 1 && runs.size() == 1) return {one, false, "no value: " + absence(one, *without.front())};
  std::vector<double> worst{wants_more(one.comparison) ? -kInfinity : kInfinity};
  if (one.comparison == Relation::equal) worst.push_back(-kInfinity);
  ExpectationResult out{one, true, {}};
  for (const double end : worst) {
    std::vector<double> sorted = values;
    sorted.insert(sorted.end(), without.size(), end);
    std::sort(sorted.begin(), sorted.end());
    const double value = statistic_of(one, sorted);
    out.holds = out.holds && satisfies(value, one.comparison, one.bound);
    out.got = std::isfinite(value) ? shown(one, value) + seeds_words(runs) : "no value";
  }
  if (!without.empty() && !out.holds) {
    const RunOutcome& first = *without.front();
    out.got += fmt::format(": {} of {} runs have no value and count as the worst ({}: {})", without.size(), runs.size(),
                           first.label, absence(one, first));
  }
  return out;
}

ExpectationResult judge_count(const Expectation& one, const std::vector<RunOutcome>& runs) {
  const auto failed =
      std::count_if(runs.begin(), runs.end(), [](const RunOutcome& run) { return !run.failure.empty(); });
  return {one, satisfies(static_cast<double>(failed), one.comparison, one.bound),
          fmt::format("{}{}", failed, runs.size() == 1 ? std::string() : fmt::format(" of {}", runs.size()))};
}

/// XML entities. Tabs and line ends need entities, because parsers of XML read them as spaces in attributes.
constexpr std::array<std::pair<char, std::string_view>, 7> kEntities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\t', "&#9;"}, {'\n', "&#10;"}, {'\r', "&#13;"}}};

/// Returns `text`, escaped for an XML attribute in double quotes.
std::string xml_text(const std::string& text) {
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    const auto entity =
        std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& one) { return one.first == rest.front(); });
    const std::size_t length = utf8_length(rest);
    const std::string_view sequence = rest.substr(0, std::max<std::size_t>(length, 1));
    // U+FFFE and U+FFFF are valid UTF-8, but XML does not allow them.
    const bool is_none = length == 0 || static_cast<unsigned char>(rest.front()) < 0x20 || sequence == "\xef\xbf\xbe" ||
                         sequence == "\xef\xbf\xbf";
    out += entity != kEntities.end() ? entity->second : is_none ? "\xef\xbf\xbd" : sequence;
    rest.remove_prefix(sequence.size());
  }
  return out;
}

}  // namespace

std::vector<ExpectationResult> judge(const std::vector<Expectation>& expectations,
                                     const std::vector<RunOutcome>& runs) {
  std::vector<ExpectationResult> verdicts;
  for (const Expectation& one : expectations)
    verdicts.push_back(one.field == kFailedRuns           ? judge_count(one, runs)
                       : one.statistic == Statistic::each ? judge_each(one, runs)
                                                          : judge_statistic(one, runs));
  return verdicts;
}

std::string verdict_line(const ExpectationResult& verdict) {
  const Expectation& one = verdict.expectation;
  return fmt::format("{}: expected {} {}, got {}", one.place, one.key, one.wanted, verdict.got);
}

std::vector<TestCase> test_cases(const std::string& suite, const std::vector<RunOutcome>& runs,
                                 const std::vector<ExpectationResult>& verdicts) {
  std::vector<TestCase> cases;
  // If the expectation of `failed_runs` is met, failed runs do not make the suite fail.
  const bool tolerated = std::any_of(verdicts.begin(), verdicts.end(), [](const ExpectationResult& one) {
    return one.expectation.field == kFailedRuns && one.holds;
  });
  for (const RunOutcome& run : runs) {
    const std::optional<double> seconds = run.summary ? run.summary->number("wall_seconds") : std::nullopt;
    cases.push_back({suite, run.name, seconds.value_or(0.0), run.failure, tolerated});
  }
  for (const ExpectationResult& verdict : verdicts) {
    const Expectation& one = verdict.expectation;
    cases.push_back({suite + ".expect", one.key + " " + one.wanted, 0.0,
                     verdict.holds ? std::string() : verdict_line(verdict), false});
  }
  return cases;
}

std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases) {
  const auto failures = std::count_if(cases.begin(), cases.end(),
                                      [](const TestCase& one) { return !one.failure.empty() && !one.tolerated; });
  const auto skipped = std::count_if(cases.begin(), cases.end(),
                                     [](const TestCase& one) { return one.tolerated && !one.failure.empty(); });
  double seconds = 0.0;
  for (const TestCase& one : cases) seconds += one.seconds;
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"0\" time=\"{:.6f}\"", cases.size(), failures, seconds);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites " + counts + ">\n";
  out += fmt::format("  <testsuite name=\"{}\" {} skipped=\"{}\">\n", xml_text(suite), counts, skipped);
  for (const TestCase& one : cases) {
    out += fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.6f}\"", xml_text(one.group),
                       xml_text(one.name), one.seconds);
    out += one.failure.empty() ? std::string("/>\n")
                               : fmt::format(">\n      <{} message=\"{}\"/>\n    </testcase>\n",
                                             one.tolerated ? "skipped" : "failure", xml_text(one.failure));
  }
  return out + "  </testsuite>\n</testsuites>\n";
}

}  // namespace palpate
