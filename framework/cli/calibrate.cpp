// SPDX-License-Identifier: MIT
#include "cli/calibrate.hpp"

#include "calibrate/calibrate.hpp"
#include "cli/output.hpp"

namespace palpate::cli {

int calibrate(CommandEnvironment& program, const CalibrateArguments& arguments) {
  std::vector<RecordedRun> recordings;
  for (const std::string& directory : arguments.runs) {
    check_one_run(directory);
    recordings.push_back(read_recorded_run(program.host, directory));
  }
  print_text(palpate::calibrate(program, recordings));
  return kDone;
}

}  // namespace palpate::cli
