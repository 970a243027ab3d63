// SPDX-License-Identifier: MIT
#include "calibrate/calibrate.hpp"

#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace palpate::cli {

int calibrate(Program& program, const std::vector<std::string>& directories) {
  std::vector<Recording> recordings;
  for (const std::string& directory : directories) {
    check_one_run(directory);
    recordings.push_back(read_recording(program, directory));
  }
  print_text(palpate::calibrate(program, recordings));
  return kDone;
}

}  // namespace palpate::cli
