// SPDX-License-Identifier: MIT
// Arguments of `palpate calibrate`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct CalibrateArguments {
  std::vector<std::string> runs;
};
PALPATE_WHOLE int calibrate(CommandEnvironment& program, const CalibrateArguments& arguments);

inline void add_calibrate(CommandLine& line) {
  auto [command, taps] = line.add<CalibrateArguments>(
      "calibrate", "Estimate the errors of an arm from recorded taps, and print an effects file for the simulator",
      calibrate, kNeedsEverything);
  command.record("RUN", taps.runs, RecordKind::run,
                 "runs in scenes exactly as configured, for example a bare desk or a block");
  command.examples({"palpate calibrate runs/bare_desk/*", "palpate calibrate runs/bare_desk/* runs/block/*"});
}

}  // namespace palpate::cli
