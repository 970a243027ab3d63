// SPDX-License-Identifier: MIT
// Arguments of `palpate explain`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct ExplainArguments {
  std::string directory;
  int tap = 0;  ///< number of the tap, counted from 1
};
PALPATE_WHOLE int explain(CommandEnvironment& program, const ExplainArguments& arguments);

inline void add_explain(CommandLine& line) {
  auto [command, explained] = line.add<ExplainArguments>(
      "explain", "Explain in words why a run chose the position of a tap", explain,
      [](NeededParts& needs, const ExplainArguments& arguments) { needs.whole_and_record(arguments.directory); });
  command.record("RUN", explained.directory, RecordKind::run, "run");
  command.argument("TAP", explained.tap, "N", "number of the tap, counted from 1", {required()});
  command.examples({"palpate explain runs/object_i/422cd70eb5f7 9", "palpate explain runs/first/* 9"});
}

}  // namespace palpate::cli
