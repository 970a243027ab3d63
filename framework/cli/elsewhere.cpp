// SPDX-License-Identifier: MIT
// The commands that take more than core. `palpate` has them in name: it becomes the program that has them all, with the
// same words. That way the first run waits for neither sweeps nor pages to be compiled.
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include <unistd.h>

namespace palpate::cli {
namespace {

[[noreturn]] int hand_over(const Program& program) {
  std::vector<std::string> words = program.command_line;
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string whole = program.installation.whole.string();
  keep_parent();
  ::execv(whole.c_str(), pointers.data());
  const std::string reason = errno == ENOENT ? "is not built" : std::strerror(errno);
  throw Error(whole, "has this command but " + reason,
              fmt::format("build it with ./palpate, or with 'cmake --build {} --target palpate_whole'",
                          program.installation.whole.parent_path().string()));
}

}  // namespace

int sweep(Program& program, const SweepArguments&) { return hand_over(program); }
int list_runs(Program& program, const ListArguments&) { return hand_over(program); }
int watch(Program& program, const WatchArguments&) { return hand_over(program); }
int pareto(Program& program, const ParetoArguments&) { return hand_over(program); }
int compare(Program& program, const CompareArguments&) { return hand_over(program); }
int curves(Program& program, const CurvesArguments&) { return hand_over(program); }
int report(Program& program, const ReportArguments&) { return hand_over(program); }
int explain(Program& program, const std::string&, int) { return hand_over(program); }
int calibrate(Program& program, const std::vector<std::string>&) { return hand_over(program); }
int export_run(Program& program, const std::string&, const std::string&, const std::string&) {
  return hand_over(program);
}
int resume_sweep(Program& program, const ResumeArguments&) { return hand_over(program); }
int status_of_sweep(Program& program, const std::string&) { return hand_over(program); }
std::size_t jobs_of_sweep(Program& program, const std::string&) { return hand_over(program); }

}  // namespace palpate::cli
