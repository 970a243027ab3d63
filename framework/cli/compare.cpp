// SPDX-License-Identifier: MIT
#include "cli/compare.hpp"

#include "analysis/compare_plan.hpp"
#include "analysis/compare_report.hpp"
#include "analysis/importance.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "config/catch_error.hpp"
#include "record/catalogue.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/resolved_config.hpp"
#include "sweep/results_after_taps.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the path of the CSV table, in the folder of results.csv. Each condition and each checkpoint has a separate
/// file.
fs::path table_file(const Sweep& sweep, const Comparison& comparison, const std::string& where) {
  std::string name = fmt::format("compare_{}_{}", slug(fmt::format("{}", fmt::join(comparison.by, "_"))),
                                 slug(comparison.metric.name));
  if (comparison.occasion) name += "_" + comparison.occasion->key();
  return sweep.directory / (name + where_suffix(where) + ".csv");
}

/// Returns the checkpoints at which jobs are compared, each once: the goal of --until first, then the numbers of --at
/// in their order.
std::vector<Checkpoint> occasions_of(const CompareArguments& arguments) {
  std::vector<Checkpoint> out;
  if (arguments.until) out.push_back(Checkpoint::once(field_name(*arguments.until)));
  for (const int count : arguments.at) {
    const Checkpoint one = Checkpoint::after(count);
    if (std::find(out.begin(), out.end(), one) == out.end()) out.push_back(one);
  }
  return out;
}

/// Returns the parts of a comparison that the output format shows. Throws Error if --ratio or --baseline is combined
/// with a format that shows no pairs.
CompareExtent extent_of(const CompareArguments& arguments) {
  const bool pairs = arguments.format != "markdown" && arguments.format != "latex";
  for (const char* const option : {arguments.ratio ? "--ratio" : "", arguments.baseline ? "--baseline" : ""}) {
    if (!pairs && *option != '\0')
      throw Error("command line", fmt::format("{}: the {} table has no pairs", option, arguments.format),
                  "choose --format text, csv or json");
  }
  if (pairs) return CompareExtent::pairs;
  return arguments.format == "latex" ? CompareExtent::intervals : CompareExtent::means;
}

/// Returns rows as CSV, or as a JSON list with one object per line.
std::string rows_text(const std::vector<Row>& rows, const std::string& format) {
  if (format == "csv") return to_csv(rows);
  std::string out = "[";
  for (const Row& row : rows) out += (&row == &rows.front() ? "\n" : ",\n") + to_json_line(row);
  return out + "\n]\n";
}

/// Returns one comparison per metric and checkpoint, or one per metric at the end of the jobs. Returns nullopt after an
/// interrupt. All comparisons are computed before the first is printed, so an unknown metric causes an error without
/// other output.
std::optional<std::vector<Comparison>> compare_all(const CommandEnvironment& program, const Sweep& sweep,
                                                   const CompareArguments& arguments) {
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  std::vector<Comparison> comparisons;
  const auto add = [&](const std::vector<Row>& results, const std::optional<Checkpoint>& occasion) {
    for (const std::string& metric : arguments.metrics) {
      const CompareQuery query{arguments.by,       metric,          where ? &*where : nullptr,
                               arguments.baseline, arguments.ratio, extent_of(arguments)};
      comparisons.push_back(palpate::compare(sweep, results, query));
      comparisons.back().occasion = occasion;
    }
  };
  const std::vector<Checkpoint> occasions = occasions_of(arguments);
  if (occasions.empty()) {
    if (arguments.workers) throw Error("command line", "-j: there is nothing to compute without --at or --until");
    add(sweep_results(sweep), std::nullopt);
    return comparisons;
  }
  // Invalid metrics are rejected before the long computation. The condition is not passed here, because the values that
  // it needs are not computed yet.
  for (const std::string& metric : arguments.metrics) {
    if (arguments.until && metric == kReached) continue;
    palpate::compare(sweep, sweep_results(sweep),
                     {arguments.by, metric, nullptr, arguments.baseline, false, CompareExtent::means});
  }
  const auto results = results_at(sweep, occasions, [&](const TapSummaries& summaries) {
    return compute_jobs(program, summaries.missing(), arguments.workers,
                        [&](std::size_t job) { summaries.compute(program, job); });
  });
  if (!results) return std::nullopt;
  for (std::size_t i = 0; i < results->size(); ++i) add((*results)[i], occasions[i]);
  return comparisons;
}

/// Selects the comparison of the plan if neither --by nor --metric is given; --where and --baseline are kept if given.
/// Returns whether the arguments select this comparison. A format without pairs has no baseline.
bool follow_plan(const ComparePlan& plan, CompareArguments& arguments) {
  const bool has_pairs = extent_of(arguments) == CompareExtent::pairs;
  if (arguments.by.empty() && arguments.metrics.empty() && !arguments.importance) {
    std::tie(arguments.by, arguments.metrics) = std::tie(plan.by, plan.metrics);
    if (!arguments.where) arguments.where = plan.where;
    if (!arguments.baseline && has_pairs) arguments.baseline = plan.baseline;
  }
  return arguments.by == plan.by && arguments.metrics == plan.metrics && arguments.where == plan.where &&
         (arguments.baseline == plan.baseline || !has_pairs) && occasions_of(arguments).empty();
}

/// Prints the importance of the swept keys for each metric.
int print_importance(const Sweep& sweep, const CompareArguments& arguments) {
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  std::vector<Row> rows;
  for (const std::string& metric : arguments.metrics) {
    const Importance made = compute_importance(sweep, sweep_results(sweep), metric, where ? &*where : nullptr);
    rows.insert(rows.end(), made.table.rows().begin(), made.table.rows().end());
    if (arguments.format == "text") print_text(made.text + "\n");
    if (arguments.format == "markdown") print_text(made.table.markdown());
    if (arguments.format == "latex") print_text(made.table.latex());
  }
  if (arguments.format == "csv" || arguments.format == "json") print_data(rows_text(rows, arguments.format));
  return kDone;
}

}  // namespace

int compare(CommandEnvironment& program, const CompareArguments& given) {
  CompareArguments arguments = given;
  extent_of(arguments);
  const std::optional<ComparePlan> plan = recorded_plan(find_records(arguments.records));
  const bool is_planned = plan && follow_plan(*plan, arguments);
  if (arguments.by.empty() && !arguments.importance)
    throw Error("", "--by or --importance is required", "see palpate compare --help");
  if (arguments.metrics.empty()) throw Error("", "--metric is required", "see palpate compare --help");
  const Sweep sweep = read_records(arguments.records, arguments.by);
  if (arguments.importance) return print_importance(sweep, arguments);
  auto comparisons = compare_all(program, sweep, arguments);
  if (!comparisons) return kInterrupted;
  const std::string planned = mark_planned(*comparisons, plan, is_planned);
  if (arguments.format == "csv" || arguments.format == "json") {
    std::vector<Row> rows;
    for (const Comparison& one : *comparisons) {
      std::vector<Row> more = compare_rows(one, arguments.where.value_or(""));
      std::move(more.begin(), more.end(), std::back_inserter(rows));
    }
    print_data(rows_text(rows, arguments.format));
    return kDone;
  }
  if (arguments.format != "text") {
    if (arguments.format == "latex") print_text("% " + planned + "\n");
    print_text(arguments.format == "latex" ? latex_table(*comparisons) : means_table(*comparisons));
    return kDone;
  }
  for (const Comparison& one : *comparisons) print_out("{}\n", compare_tables(one));
  print_text(planned + "\n" + compare_legend(*comparisons));
  const std::string condition = arguments.where.value_or("");
  for (const Comparison& one : *comparisons) {
    const fs::path file = table_file(sweep, one, condition);
    write_file(file, to_csv(compare_rows(one, condition)));
    print_message(fmt::format("table: {}\n", file.string()));
  }
  return kDone;
}

}  // namespace palpate::cli
