// SPDX-License-Identifier: MIT
// The same config and seed give the same bytes, and the record says what could make them differ.
#include "gp/simd/table.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate {
namespace {

using ARun = Shell;

TEST_F(ARun, GivesTheSameBytesUnderTheSameIdEachTimeAndOnAnyNumberOfThreads) {
  for (const char* posterior : {"posterior=dense", "posterior=grid", "posterior=lowrank"}) {
    fs::path first;
    for (const char* threads : {"1", "2", "3", "1"}) {
      const fs::path again = ran({"candidates.count=150", posterior, std::string("threads=") + threads});
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
              HasSubstr(std::string("\"instruction_path\": \"") + simd::fastest().name + "\""));
  EXPECT_THAT(part_of(ran("--runs baseline instruction_set=baseline"), "manifest"),
              HasSubstr("\"instruction_path\": \"SSE2\""));
}

}  // namespace
}  // namespace palpate
