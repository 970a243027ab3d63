// SPDX-License-Identifier: MIT
#include "cli/gate.hpp"

#include "cli/command_context.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <algorithm>

#include <unistd.h>

namespace palpate::cli {

namespace fs = std::filesystem;

void check_junit(const std::string& junit) {
  if (junit.empty()) return;
  const fs::path folder = fs::absolute(junit).parent_path();
  if (fs::is_directory(junit)) throw Error(junit, "is a folder", "name a file for --junit");
  if (!fs::is_directory(folder)) throw Error(junit, "its folder does not exist", "create it first");
  if (::access(folder.c_str(), W_OK) != 0) throw Error(junit, "its folder is not writable");
}

void write_junit(const std::vector<ExpectationResult>& verdicts, const std::vector<RunOutcome>& runs,
                 const GateOutput& output) {
  if (output.junit.empty()) return;
  write_file(output.junit, junit_xml(output.suite, test_cases(output.suite, runs, verdicts)));
}

bool conclude(const std::vector<Expectation>& expectations, const std::vector<RunOutcome>& runs,
              const GateOutput& output) {
  const std::vector<ExpectationResult> verdicts = judge(expectations, runs);
  const auto held =
      std::count_if(verdicts.begin(), verdicts.end(), [](const ExpectationResult& one) { return one.holds; });
  if (output.count_on_stdout && !verdicts.empty()) print_out("expected: {} of {}\n", held, verdicts.size());
  flush_output();
  for (const ExpectationResult& verdict : verdicts) {
    if (!verdict.holds) print_message(verdict_line(verdict) + "\n");
  }
  write_junit(verdicts, runs, output);
  return held == static_cast<std::ptrdiff_t>(verdicts.size());
}

int sweep_status(const std::vector<Expectation>& expectations, bool all_hold, bool any_failed) {
  const bool counted = std::any_of(expectations.begin(), expectations.end(),
                                   [](const Expectation& one) { return one.field == kFailedRuns; });
  return all_hold && (counted || !any_failed) ? kDone : kFailed;
}

}  // namespace palpate::cli
