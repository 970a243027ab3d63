// SPDX-License-Identifier: MIT
// Arguments of `palpate compare`.
#pragma once

#include "cli/command_line.hpp"

#include <utility>

namespace palpate::cli {

/// The jobs, groups and columns that `palpate compare` and `palpate power` take.
struct ComparedArguments {
  std::vector<std::string> records;  ///< sweeps and runs, as find_records() takes them; they are pooled into one sweep
  std::vector<std::string> by;
  std::vector<std::string> metrics;
  std::optional<std::string> where;
  std::optional<std::string> baseline;
};

/// Adds the arguments, and returns --by and --baseline. `planned`: whether the plan of a sweep may replace --by and
/// --metric.
inline std::pair<Argument, Argument> add_compared(const Command& command, ComparedArguments& query, bool planned) {
  command.pooled_records(query.records);
  const Argument by =
      command.argument("--by", query.by, "KEYS", "swept keys that define the groups, for example acquisition,kernel",
                       {comma_separated(), required(!planned)});
  command.argument("--metric", query.metrics, "COLUMNS",
                   std::string("columns of results.csv to compare, for example object_taps,footprint_iou") +
                       (planned ? ". Without --by and --metric, the sweep's 'compare:' block is used" : ""),
                   {comma_separated(), required(!planned)});
  command.argument("--where", query.where, "CONDITION",
                   "compare only jobs that satisfy this condition, for example \"first_hit_tap <= 3\"");
  return {by, command.argument("--baseline", query.baseline, "GROUP",
                               "group with which every other group is compared, for example uncertainty")};
}

struct CompareArguments : ComparedArguments {
  /// numbers of taps at which jobs are compared; if empty, jobs are compared at their ends
  std::vector<int> at;
  std::optional<std::string> until;  ///< COLUMN=VALUE: jobs are compared after the first tap that reached this value
  bool ratio = false;
  bool importance = false;  ///< whether to print the importance of the swept keys instead of groups
  std::string format = "text";
  std::optional<int> workers;
};
PALPATE_WHOLE int compare(CommandEnvironment& program, const CompareArguments& arguments);

inline void add_compare(CommandLine& line) {
  auto [command, query] = line.add<CompareArguments>(
      "compare", "Compare groups of jobs of a sweep, with confidence intervals and paired tests", compare,
      [](NeededParts& needs, const CompareArguments& arguments) {
        arguments.at.empty() && !arguments.until ? needs.whole() : needs.everything();
      });
  const auto [by, baseline] = add_compared(command, query, true);
  const Argument at = command.argument("--at", query.at, "NUMBERS",
                                       "numbers of taps after which the jobs are compared, for example 17,30",
                                       {comma_separated(), at_least(1)});
  const Argument until = command.argument(
      "--until", query.until, "COLUMN=VALUE",
      "value of a summary field, for example rmse_m=8mm. Each job is compared at the tap that reaches the "
      "value. A job that never reaches the value is compared at its end",
      {not_with(at)});
  const Argument ratio = command.flag("--ratio", query.ratio, "also print the ratio of the means of each pair");
  const Argument importance =
      command.flag("--importance", query.importance,
                   "in place of --by: share of the variance between settings that each swept key and each pair of keys "
                   "explains. A Gaussian process approximates the shares if not every combination of values has run",
                   {not_with(by), not_with(baseline), not_with(at), not_with(until), not_with(ratio)});
  command.argument("--format", query.format, "NAME",
                   "output format. text also writes CSV files next to results.csv, except with --importance. csv and "
                   "json contain groups and pairs, or shares. latex is a booktabs table of means, intervals and n. "
                   "markdown is a table of means",
                   {one_of({"text", "markdown", "csv", "json", "latex"}), with_default()});
  command.argument("-j", query.workers, "N",
                   "number of jobs that --at or --until computes in parallel; default: number of cores",
                   {between(1, kMaxWorkers), not_with(importance)});
  command.examples(
      {"palpate compare runs/many/* --by acquisition --metric object_taps",
       "palpate compare runs/many/* --by acquisition --metric rmse_m,footprint_iou --at 17,30 --format latex",
       "palpate compare runs/many/* --importance --metric rmse_m"});
}

}  // namespace palpate::cli
