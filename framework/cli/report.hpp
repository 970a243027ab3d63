// SPDX-License-Identifier: MIT
// Arguments of `palpate report`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct ReportArguments {
  std::vector<std::string> directories;  ///< a run, a sweep, or several runs for a common page
  std::string to;                        ///< output folder; "": the default
  bool figures = false;
  bool paper = false;
};
PALPATE_WHOLE int report(CommandEnvironment& program, const ReportArguments& arguments);

inline void add_report(CommandLine& line) {
  auto [command, page] = line.add<ReportArguments>(
      "report", "Write an HTML page of a run or sweep, optionally with figures, or one page that compares several runs",
      report, [](NeededParts& needs, const ReportArguments& arguments) {
        for (const std::string& directory : arguments.directories) needs.whole_and_record(directory);
      });
  command.record("DIR", page.directories, RecordKind::any, "run or sweep, or several runs");
  command.flag("--figures", page.figures, "also draw the panels as PNG files, with gnuplot");
  command.flag("--paper", page.paper, "draw figures in the layout of the figures in the paper");
  command.argument(
      "--to", page.to, "FOLDER",
      "output folder; default: the folder of the run or sweep. For several runs, the default is the folder "
      "that contains all of them");
  command.examples(
      {"palpate report runs/object_i/422cd70eb5f7 --figures", "palpate report runs/first/* runs/second/*"});
}

}  // namespace palpate::cli
