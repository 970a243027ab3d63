// SPDX-License-Identifier: MIT
// The same config and seed give the same bytes, and the record says what could make them differ.
#include "math/instructions.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate {
namespace {

using ARun = Shell;

TEST_F(ARun, GivesTheSameBytesUnderTheSameIdEachTimeAndOnAnyNumberOfThreads) {
  for (const char* posterior : {"belief.engine.type=dense", "belief.engine.type=grid", "belief.engine.type=lowrank"}) {
    fs::path first;
    for (const char* threads : {"1", "2", "3", "1"}) {
      const fs::path again = ran({"candidates.count=150", posterior, std::string("belief.engine.threads=") + threads});
      if (first.empty()) {
        first = here() / again.filename();
        fs::rename(again, first);
        continue;
      }
      EXPECT_EQ(again.filename(), first.filename()) << posterior;
      EXPECT_EQ(text_of(again / "taps.csv"), text_of(first / "taps.csv")) << posterior << " on " << threads;
      EXPECT_EQ(lines(text_of(again / "taps.csv")), 18);
      fs::remove_all(again);
    }
  }
}

TEST_F(ARun, NamesTheInstructionSetOfItsLoopsInTheManifest) {
  EXPECT_THAT(part_of(ran(), "manifest"),
              HasSubstr(std::string("\"instruction_path\": \"") + math::name_of(instructions_in_use()) + "\""));
  const test::EnvironmentVariable variable("PALPATE_INSTRUCTIONS", "baseline");
  EXPECT_THAT(part_of(ran("--runs baseline"), "manifest"), HasSubstr("\"instruction_path\": \"baseline\""));
}

TEST_F(ARun, RejectsAnUnknownInstructionSet) {
  const test::EnvironmentVariable variable("PALPATE_INSTRUCTIONS", "avx");
  std::string known;
  for (const Instructions one : math::instruction_sets())
    known += (known.empty() ? "" : " or ") + std::string(math::name_of(one));
  const std::string message = "PALPATE_INSTRUCTIONS: unknown value 'avx', write " + known + ", or unset it";
  EXPECT_THAT(refused(Words{"run", config("paper/object_i.yaml")}), HasSubstr(message));
  EXPECT_THAT(refused(Words{"sweep", config("paper/object_i.yaml"), "seed=1,2", "--runs", "swept"}),
              HasSubstr(message));
  EXPECT_FALSE(fs::exists(here() / "swept"));
}

}  // namespace
}  // namespace palpate
