// SPDX-License-Identifier: MIT
// Arguments of `palpate bundle`, and of the commands that read a bundle.
#pragma once

#include "cli/command_line.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

struct BundleArguments {
  std::vector<std::string> records;  ///< sweeps and runs, as find_records() takes them
  std::string output;
  std::vector<std::string> results;
  std::vector<std::string> sources;
};
PALPATE_WHOLE int bundle(CommandEnvironment& program, const BundleArguments& arguments);

inline void add_bundle(CommandLine& line) {
  auto [command, arguments] = line.add<BundleArguments>(
      "bundle", "Pack sweeps and runs with all that is needed to repeat them into one archive", bundle,
      kNeedsEverything);
  command.pooled_records(arguments.records);
  command.argument("-o", arguments.output, "FILE", "archive to write; default: NAME.palpate.tar.gz");
  command.argument("--result", arguments.results, "COMMAND",
                   "compare, pareto or curves with its options: a table or figure of the paper, which 'palpate verify' "
                   "makes again. Names of sweeps before the options select them; without names, all records are used. "
                   "Default: the planned comparison, if all records have the same",
                   {one_per_option()});
  command.argument("--sources", arguments.sources, "FOLDER",
                   "folder with the sources of plugins and programs that palpate does not contain", {one_per_option()});
  command.examples(
      {"palpate bundle runs/many/* --result \"compare --by acquisition --metric rmse_m\" -o paper.palpate.tar.gz",
       "palpate bundle runs/first/*"});
}

}  // namespace palpate::cli
