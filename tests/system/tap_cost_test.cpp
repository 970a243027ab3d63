// SPDX-License-Identifier: MIT
// Effects that a scene does not have cost nothing: counted in instructions, which do not depend on the machine's load.
#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <string>

namespace palpate::test {
namespace {

constexpr const char* kValgrind = "/usr/bin/valgrind";

/// Instructions that valgrind counts for `program --perfect taps`; -1 where it cannot run.
double instructions(const std::string& program, int taps) {
  const TemporaryFolder folder;
  const Ended ended = run_program(
      {kValgrind, "--tool=callgrind", "--callgrind-out-file=callgrind.out", program, "--perfect", std::to_string(taps)},
      folder.path());
  std::smatch found;
  if (ended.status != 0 || !std::regex_search(ended.err, found, std::regex("Collected : ([0-9]+)"))) {
    ADD_FAILURE() << ended.err;
    return -1.0;
  }
  return std::stod(found[1]);
}

TEST(TapCost, OfAPerfectTapIsThatOfASimulatorWithTheEffectsCompiledOut) {
  if (kSanitized) GTEST_SKIP() << "sanitizers and valgrind do not go together";
  if (!std::filesystem::exists(kValgrind)) GTEST_SKIP() << "valgrind is not installed";
  for (const char* program : {PALPATE_TAP_COST, PALPATE_TAP_COST_WITHOUT_EFFECTS}) {
    if (!std::filesystem::exists(program)) GTEST_SKIP() << "what measures is built by ./check --all";
  }
  constexpr int kTaps = 4000;
  // What the start of the program costs is taken off: it varies with the environment, not with the taps.
  const auto per_tap = [](const std::string& program) {
    return (instructions(program, 2 * kTaps) - instructions(program, kTaps)) / kTaps;
  };
  const double with = per_tap(PALPATE_TAP_COST);
  const double without = per_tap(PALPATE_TAP_COST_WITHOUT_EFFECTS);
  ASSERT_GT(without, 50.0) << "there must be something to compare";
  EXPECT_LE(with, 1.02 * without) << with << " and " << without << " instructions a tap";
  RecordProperty("instructions_with", std::to_string(with));
  RecordProperty("instructions_without", std::to_string(without));
}

}  // namespace
}  // namespace palpate::test
