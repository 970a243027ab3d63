// SPDX-License-Identifier: MIT
// Arguments of `palpate list`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct ListArguments {
  std::string folder = "runs";
  std::optional<std::string> where;
  bool json = false;
};
PALPATE_WHOLE int list_runs(CommandEnvironment& program, const ListArguments& arguments);

inline void add_list(CommandLine& line) {
  auto [command, list] = line.add<ListArguments>("list", "List the runs and sweeps in a folder, sorted by start time",
                                                 list_runs, kNeedsWhole);
  command.argument("FOLDER", list.folder, "FOLDER",
                   "folder to search, three levels deep, for example runs, runs/NAME, or a parent folder",
                   {with_default()});
  command.argument("--where", list.where, "CONDITION",
                   "list only runs that satisfy a condition on columns, summary fields and config keys, for example "
                   "\"rmse_m < 8 mm and kernel.type == rbf\"");
  command.flag("--json", list.json, "print the list as JSON");
  command.examples({"palpate list", "palpate list runs/first --where \"rmse_m < 8 mm and seed > 3\""});
}

}  // namespace palpate::cli
