// SPDX-License-Identifier: MIT
// Judges runs by what their config expects: one by its summary, many, as the jobs of a sweep, by all of theirs; in the
// XML of JUnit, too.
#pragma once

#include "record/expectation.hpp"
#include "record/row.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// How one run ended, as far as a gate cares.
struct RunOutcome {
  std::string name;     ///< "run 910071e8f4bb", "job 3: acquisition=weighted, seed=3"
  std::string label;    ///< "job 3"; "" where there is but one run
  std::string failure;  ///< why it failed or never ran; "" when it is done
  std::optional<Row> summary;
  std::optional<std::string> seed = std::nullopt;  ///< of a sweep over seeds: jobs with the same one count as one
};

/// One expectation, and whether it is fulfilled.
struct Verdict {
  Expectation expectation;
  bool holds = false;
  std::string got;  ///< "11", "3.2 cm in job 4", "no value: ..."
};

/// Judges `runs` (at least one). A field alone has to hold in every run. In a statistic a run that failed or has no
/// value, or one that is not finite, takes the worst value that there is, and of a sweep over several seeds the verdict
/// says over how many the statistic is. `failed_runs` counts the runs that failed.
std::vector<Verdict> judge(const std::vector<Expectation>& expectations, const std::vector<RunOutcome>& runs);

/// "file:line:column: expected median(object_taps) >= 12, got 11"
std::string verdict_line(const Verdict& verdict);

/// One test as JUnit has it, which continuous integration shows.
struct TestCase {
  std::string group;  ///< JUnit's classname
  std::string name;
  double seconds = 0.0;
  std::string failure;     ///< one line; "" when it passed
  bool tolerated = false;  ///< its failure is told, but not counted
};

/// A test case a run and one an expectation. `suite` is the name of the experiment.
std::vector<TestCase> test_cases(const std::string& suite, const std::vector<RunOutcome>& runs,
                                 const std::vector<Verdict>& verdicts);

/// A document in the XML of JUnit, with one suite. Bytes that XML 1.0 cannot hold become U+FFFD.
std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases);

}  // namespace palpate
