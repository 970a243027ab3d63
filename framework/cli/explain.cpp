// SPDX-License-Identifier: MIT
#include "cli/explain.hpp"

#include "cli/output.hpp"
#include "report/words/explain.hpp"

namespace palpate::cli {

int explain(CommandEnvironment& program, const ExplainArguments& arguments) {
  check_one_run(arguments.directory);
  const RecordedRun recording = read_recorded_run(program.host, arguments.directory);
  print_text(explain_tap(program, recording, arguments.tap));
  return kDone;
}

}  // namespace palpate::cli
