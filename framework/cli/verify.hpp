// SPDX-License-Identifier: MIT
// Arguments of `palpate verify`.
#pragma once

#include "cli/command_line.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace palpate::cli {

/// Default of --max-size, GiB.
inline constexpr int kMaxSize = 1;
inline constexpr const char* kMaxSizeHelp = "largest size of the unpacked bundle in GiB";
inline std::uintmax_t bytes_of_gib(int size) { return static_cast<std::uintmax_t>(size) << 30; }

struct VerifyArguments {
  std::string bundle;
  std::optional<int> sample;
  bool with_plugins = false;
  std::optional<int> workers;
  int max_size = kMaxSize;
};
PALPATE_WHOLE int verify(CommandEnvironment& program, const VerifyArguments& arguments);

inline void add_verify(CommandLine& line) {
  auto [command, arguments] = line.add<VerifyArguments>(
      "verify", "Make the runs, tables and figures of a bundle again and compare", verify, kNeedsEverything);
  command.argument("BUNDLE", arguments.bundle, "FILE", "archive that 'palpate bundle' wrote", {required()});
  command.argument("--sample", arguments.sample, "N", "repeat only N runs, chosen at random. All other checks remain",
                   {at_least(1)});
  command.flag("--with-plugins", arguments.with_plugins,
               "build the sources in the bundle, and run these plugins and programs. Only for bundles of authors whom "
               "you trust; a terminal is asked first");
  command.argument("-j", arguments.workers, "N", "number of runs repeated in parallel; default: number of cores",
                   {between(1, kMaxWorkers)});
  command.argument("--max-size", arguments.max_size, "GIB", kMaxSizeHelp, {at_least(1), with_default()});
  command.examples({"palpate verify paper.palpate.tar.gz", "palpate verify paper.palpate.tar.gz --sample 100"});
}

}  // namespace palpate::cli
