// SPDX-License-Identifier: MIT
// Compares the summary of one run, or the summaries of all jobs of a sweep, with the expectations of their config. Also
// writes the results as JUnit XML.
#pragma once

#include "record/expectation.hpp"
#include "record/row.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Result of one run, with the data that a gate needs.
struct RunOutcome {
  std::string name;     ///< "run 910071e8f4bb", "job 3: acquisition=weighted, seed=3"
  std::string label;    ///< "job 3"; "" if there is only one run
  std::string failure;  ///< reason why the run failed or has not ended; "" if it is done
  std::optional<Row> summary;
  std::optional<std::string> seed = std::nullopt;  ///< seed of a job; the number of different seeds is reported
};

/// An expectation, and whether it is fulfilled.
struct ExpectationResult {
  Expectation expectation;
  bool holds = false;
  std::string got;  ///< "11", "3.2 cm in job 4", "no value: ..."
};

/// Checks the expectations for `runs` (at least one run). An expectation about a field must hold in every run. In a
/// statistic, a run that failed or has no finite value counts as the worst possible value. If the runs have different
/// seeds, the verdict contains the number of seeds. `failed_runs` is the number of runs that failed.
std::vector<ExpectationResult> judge(const std::vector<Expectation>& expectations, const std::vector<RunOutcome>& runs);

/// Returns a line such as "file:line:column: expected median(object_taps) >= 12, got 11".
std::string verdict_line(const ExpectationResult& verdict);

/// A test case of JUnit, which continuous integration displays.
struct TestCase {
  std::string group;  ///< JUnit's classname
  std::string name;
  double seconds = 0.0;
  std::string failure;     ///< one line; "" if the test passed
  bool tolerated = false;  ///< a failure is reported but not counted
};

/// Returns one test case per run and one per expectation. `suite` is the name of the experiment.
std::vector<TestCase> test_cases(const std::string& suite, const std::vector<RunOutcome>& runs,
                                 const std::vector<ExpectationResult>& verdicts);

/// Returns a JUnit XML document with one suite. Bytes that XML 1.0 does not allow become U+FFFD.
std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases);

}  // namespace palpate
