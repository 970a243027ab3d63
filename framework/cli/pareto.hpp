// SPDX-License-Identifier: MIT
// Arguments of `palpate pareto`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct ParetoArguments {
  std::vector<std::string> records;  ///< sweeps and runs, as find_records() takes them; they are pooled into one sweep
  std::string cost;
  std::string error;
  std::optional<std::string> within;
  std::optional<std::string> where;
};
PALPATE_WHOLE int pareto(CommandEnvironment& program, const ParetoArguments& arguments);

inline void add_pareto(CommandLine& line) {
  auto [command, query] = line.add<ParetoArguments>(
      "pareto", "Show which settings of a sweep are Pareto-optimal in cost and error", pareto, kNeedsWhole);
  command.pooled_records(query.records);
  command.argument("--cost", query.cost, "COLUMN",
                   "column of results.csv to use as the cost, for example robot_seconds, compute_seconds or taps",
                   {required()});
  command.argument("--error", query.error, "COLUMN",
                   "column of results.csv to use as the error or the quality, for example rmse_m or footprint_iou",
                   {required()});
  command.argument("--within", query.within, "VALUE",
                   "bound on the error, for example 5mm. Print the config of the cheapest setting with a 95 % interval "
                   "of the error within the bound");
  command.argument("--where", query.where, "CONDITION",
                   "use only jobs that satisfy this condition, for example \"scene == ring\"");
  command.examples({"palpate pareto runs/many/* --cost robot_seconds --error rmse_m",
                    "palpate pareto runs/many/* --cost taps --error rmse_m --within 5mm"});
}

}  // namespace palpate::cli
