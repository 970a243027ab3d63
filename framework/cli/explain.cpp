// SPDX-License-Identifier: MIT
#include "report/words/explain.hpp"
#include "cli/output.hpp"

#include "cli/commands.hpp"

namespace palpate::cli {

int explain(Program& program, const std::string& directory, int tap) {
  check_one_run(directory);
  const Recording recording = read_recording(program, directory);
  print_text(explain_tap(program, recording, tap));
  return kDone;
}

}  // namespace palpate::cli
