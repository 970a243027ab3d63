// SPDX-License-Identifier: MIT
// Arguments of `palpate rerun`.
#pragma once

#include "cli/command_line.hpp"
#include "cli/verify.hpp"

#include <string>

namespace palpate::cli {

struct RerunArguments {
  std::string bundle;
  std::string run;
  std::string runs = "runs";
  int max_size = kMaxSize;
};
PALPATE_WHOLE int rerun(CommandEnvironment& program, const RerunArguments& arguments);

inline void add_rerun(CommandLine& line) {
  auto [command, arguments] = line.add<RerunArguments>("rerun", "Make one run of a bundle again, as a run of your own",
                                                       rerun, kNeedsEverything);
  command.argument("BUNDLE", arguments.bundle, "FILE", "archive that 'palpate bundle' wrote", {required()});
  command.argument("RUN", arguments.run, "ID", "id of a run in the bundle, or its first digits", {required()});
  command.argument("--runs", arguments.runs, "FOLDER", kRunsHelp, {with_default()});
  command.argument("--max-size", arguments.max_size, "GIB", kMaxSizeHelp, {at_least(1), with_default()});
  command.examples(
      {"palpate rerun paper.palpate.tar.gz 60790461c9b5", "palpate rerun paper.palpate.tar.gz 6079 --runs others"});
}

}  // namespace palpate::cli
