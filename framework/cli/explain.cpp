// SPDX-License-Identifier: MIT
#include "report/words/explain.hpp"

#include "cli/commands.hpp"
#include "cli/one_run.hpp"

#include <fmt/format.h>

namespace palpate::cli {

int explain(Program& program, const std::string& directory, int tap) {
  const Recording recording = read_one_run(program, directory);
  fmt::print("{}", explain_tap(program.workshop, recording, tap));
  return kDone;
}

}  // namespace palpate::cli
