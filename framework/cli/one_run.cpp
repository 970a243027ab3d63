// SPDX-License-Identifier: MIT
#include "cli/one_run.hpp"

#include "record/run_directory.hpp"

#include <palpate/error.hpp>

namespace palpate::cli {

void check_one_run(const std::filesystem::path& directory) {
  if (is_sweep(directory)) {
    throw Error(directory.string(), "is a sweep of many runs",
                "give one of them: " + (directory / "jobs" / "<id>").string());
  }
}

Recording read_one_run(const Program& program, const std::filesystem::path& directory) {
  check_one_run(directory);
  return read_recording(program.workshop, directory);
}

}  // namespace palpate::cli
