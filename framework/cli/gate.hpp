// SPDX-License-Identifier: MIT
// The end of a run or a sweep as continuous integration sees it: expectations, JUnit file, exit status.
#pragma once

#include "record/gate.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

/// Where the verdicts go.
struct GateOutput {
  std::string suite;             ///< name of the experiment
  std::string junit;             ///< file to write, "" for none
  bool count_on_stdout = false;  ///< "expected: 3 of 3", if there are expectations
};

/// Throws Error, of kind usage, if no file can be made in the folder of `junit`: better before a long sweep than after.
void check_junit(const std::string& junit);

/// Writes the JUnit file, if one is asked for. Throws Error.
void write_junit(const std::vector<Verdict>& verdicts, const std::vector<RunOutcome>& runs, const GateOutput& output);

/// Judges the runs, prints a line on stderr for each expectation that fails, and writes the JUnit file. Returns whether
/// all hold. Throws Error.
bool conclude(const std::vector<Expectation>& expectations, const std::vector<RunOutcome>& runs,
              const GateOutput& output);

/// The exit status of a sweep: runs that failed make it fail, unless the config says how many may.
int sweep_status(const std::vector<Expectation>& expectations, bool all_hold, bool any_failed);

}  // namespace palpate::cli
