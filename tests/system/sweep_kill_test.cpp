// SPDX-License-Identifier: MIT
// A sweep that is killed at any moment, its jobs with it, and resumed, ends with every file of itself and of its jobs
// as the unbroken one has it. PALPATE_KILLS says how many sweeps (tests/stress.sh: 150), each killed twice.
#include "support/lasting.hpp"
#include "support/support.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

namespace palpate {
namespace {

using test::TemporaryFolder;

namespace fs = std::filesystem;

/// A sweep: jobs side by side and one by one, with and without maps and fits.
std::vector<std::string> sweep_words(int number) {
  const auto config = [](const char* name) { return (test::source_folder() / "configs" / name).string(); };
  switch (number % 3) {
    case 0:
      return {"sweep",           config("paper/object_i.yaml"), "name=killed", "acquisition=[weighted,uncertainty]",
              "seed=range(0,3)", "backend.pace=0.001",          "--quiet"};
    case 1:
      return {"sweep",
              config("default.yaml"),
              "name=killed",
              "scene=[object_i,object_ii]",
              "taps=6",
              "backend.pace=0.001",
              "log.maps=true",
              "log.surface=true",
              "--quiet",
              "-j",
              "2"};
    default:
      return {"sweep",
              config("paper/object_i.yaml"),
              "name=killed",
              "taps=[5,9]",
              "fitting=ceres",
              "height.signal=5cm",
              "fitting.every=4",
              "backend.pace=0.001",
              "--quiet",
              "-j",
              "1"};
  }
}

int wanted_sweeps() {
  const char* text = std::getenv("PALPATE_KILLS");
  return text != nullptr ? std::atoi(text) : 12;
}

class KillOfASweep : public ::testing::TestWithParam<int> {};

TEST_P(KillOfASweep, ResumedItEndsWithEveryFileAsTheUnbrokenSweepHasIt) {
  const std::vector<std::string> sweep = sweep_words(GetParam());
  const TemporaryFolder whole;
  const auto begin = std::chrono::steady_clock::now();
  const test::Ended unbroken = test::palpate(sweep, whole.path());
  ASSERT_EQ(unbroken.status, 0) << unbroken.err;
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;

  const TemporaryFolder folder;
  Random random(21, "sweep_kill_test", static_cast<std::uint64_t>(GetParam()));
  const auto moment = [&](double share) { return static_cast<int>(random.uniform() * share * took.count()); };
  const auto next = [&]() -> std::vector<std::string> {
    const fs::path directory = test::run_in(folder.path() / "runs");
    return directory.empty() ? sweep : std::vector<std::string>{"resume", directory.string(), "--quiet"};
  };
  // Every other first kill comes near the end, where the tables are written.
  test::run_and_kill(sweep, folder.path(),
                     GetParam() % 2 == 0 ? moment(1.0) : static_cast<int>(0.9 * took.count()) + moment(0.1));
  test::run_and_kill(next(), folder.path(), moment(0.5));
  const test::Ended last = test::palpate(next(), folder.path());
  EXPECT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(test::lasting_files(test::run_in(folder.path() / "runs")),
            test::lasting_files(test::run_in(whole.path() / "runs")));
}

INSTANTIATE_TEST_SUITE_P(AtRandomMoments, KillOfASweep, ::testing::Range(0, wanted_sweeps()));

}  // namespace
}  // namespace palpate
