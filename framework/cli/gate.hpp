// SPDX-License-Identifier: MIT
// Expectations, JUnit file and exit status at the end of a run or sweep, for continuous integration.
#pragma once

#include "record/gate.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

/// Outputs that receive the results of the expectations.
struct GateOutput {
  std::string suite;             ///< name of the experiment
  std::string junit;             ///< JUnit file; "": none
  bool count_on_stdout = false;  ///< prints for example "expected: 3 of 3", if there are expectations
};

/// Throws Error of kind `usage` if the folder of `junit` is not writable. Call this function before a long sweep, so
/// that the error appears before it and not at its end.
void check_junit(const std::string& junit);

/// Writes the JUnit file if `output.junit` names one. Throws Error.
void write_junit(const std::vector<ExpectationResult>& verdicts, const std::vector<RunOutcome>& runs,
                 const GateOutput& output);

/// Checks the expectations, prints one line on stderr per expectation that fails, and writes the JUnit file. Returns
/// whether all expectations hold. Throws Error.
bool conclude(const std::vector<Expectation>& expectations, const std::vector<RunOutcome>& runs,
              const GateOutput& output);

/// Returns the exit status of a sweep. A sweep fails if an expectation does not hold. Failed runs also make it fail,
/// unless an expectation is about the number of failed runs.
int sweep_status(const std::vector<Expectation>& expectations, bool all_hold, bool any_failed);

}  // namespace palpate::cli
