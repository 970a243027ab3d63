// SPDX-License-Identifier: MIT
// The same config and seed give the same bytes, and the record says what could make them differ.
#include "gp/simd/table.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate {
namespace {

TEST(Run, GivesTheSameBytesUnderTheSameIdOnAnyNumberOfThreads) {
  for (const char* posterior : {"posterior=dense", "posterior=grid", "posterior=lowrank"}) {
    const TemporaryFolder folder;
    std::vector<std::string> ids;
    std::vector<std::string> taps;
    for (const char* threads : {"1", "2", "3"}) {
      test::palpate({"run", paper(), "--quiet", posterior, "candidates.count=150", "--runs", threads,
                     std::string("threads=") + threads},
                    folder.path());
      const fs::path directory = only_run(folder.path() / threads);
      ids.push_back(directory.filename().string());
      taps.push_back(text_of(directory / "taps.csv"));
    }
    EXPECT_EQ(ids, std::vector<std::string>(3, ids.front())) << posterior;
    EXPECT_EQ(taps, std::vector<std::string>(3, taps.front())) << posterior;
  }
}

TEST(Run, NamesTheInstructionSetOfItsLoopsInTheManifest) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet", "--runs", "fastest"}, folder.path());
  test::palpate({"run", paper(), "--quiet", "--runs", "baseline", "instruction_set=baseline"}, folder.path());
  const auto manifest = [&](const char* runs) { return text_of(only_run(folder.path() / runs) / "manifest.json"); };
  EXPECT_THAT(manifest("baseline"), HasSubstr("\"instruction_path\": \"SSE2\""));
  EXPECT_THAT(manifest("fastest"), HasSubstr(std::string("\"instruction_path\": \"") + simd::fastest().name + "\""));
}

TEST(Run, TheSameConfigAndSeedGiveTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* runs : {"a", "b"}) {
    ASSERT_EQ(
        test::palpate({"run", config("paper/object_i_right.yaml"), "--quiet", "--runs", runs}, folder.path()).status,
        0);
  }
  const std::string first = text_of(only_run(folder.path() / "a") / "taps.csv");
  EXPECT_EQ(first, text_of(only_run(folder.path() / "b") / "taps.csv"));
  EXPECT_EQ(lines(first), 18);
}

}  // namespace
}  // namespace palpate
