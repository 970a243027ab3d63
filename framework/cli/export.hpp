// SPDX-License-Identifier: MIT
// Arguments of `palpate export`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct ExportArguments {
  std::string directory;
  std::string format = "ply";
  std::string to;  ///< output folder; "": export/ in the run directory
};
PALPATE_WHOLE int export_run(CommandEnvironment& program, const ExportArguments& arguments);

inline void add_export(CommandLine& line) {
  auto [command, exported] = line.add<ExportArguments>(
      "export", "Export the surface and the taps of a run for other programs", export_run,
      [](NeededParts& needs, const ExportArguments& arguments) { needs.whole_and_record(arguments.directory); });
  command.record("RUN", exported.directory, RecordKind::run, "run");
  command.argument("--format", exported.format, "NAME",
                   "file format: ply is for mesh viewers, csv writes tables of the taps, timings, objects and attempts",
                   {one_of({"ply", "csv"}), with_default()});
  command.argument("--to", exported.to, "FOLDER", "output folder; default: export/ in the run directory");
  command.examples({"palpate export runs/first/*", "palpate export runs/first/* --to surfaces",
                    "palpate export runs/first/* --format csv"});
}

}  // namespace palpate::cli
