// SPDX-License-Identifier: MIT
#include "cli/explain.hpp"

#include "cli/output.hpp"
#include "report/words/explain.hpp"

namespace palpate::cli {

int explain(Program& program, const ExplainArguments& arguments) {
  check_one_run(arguments.directory);
  const Recording recording = read_recording(program, arguments.directory);
  print_text(explain_tap(program, recording, arguments.tap));
  return kDone;
}

}  // namespace palpate::cli
