// SPDX-License-Identifier: MIT
// tests/accuracy.sh can fail: over a program whose results are chosen here, and over the real one with a worse setting.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int kSeeds = 12;

class Accuracy : public Shell {
 protected:
  /// A tree with the script, and a program that leaves results.csv as the result of any sweep.
  Accuracy() {
    fs::create_directories(here() / "tests/benchmark");
    fs::copy(test::source_folder() / "tests/accuracy.sh", here() / "tests");
    fs::create_symlink(test::source_folder() / "configs", here() / "configs");
    const fs::path program = write(here() / "build/palpate", R"(#!/bin/sh
while [ $# -gt 0 ]; do
  case $1 in name=*) name=${1#name=} ;; --runs) runs=$2 ;; esac
  shift
done
mkdir -p "$runs/$name/id" && cp "$(dirname "$0")/results.csv" "$runs/$name/id"
)");
    fs::permissions(program, fs::perms::owner_all);
  }

  /// Results of two objects whose mean RMSE is 10 mm, more by 1 mm with every seed, and whose mean IoU is 0.5. `worse`
  /// is added to the RMSE of a seed, in millimetres, `iou` to all IoU.
  template <class Worse>
  void give(const Worse& worse, double iou = 0.0) const {
    std::string text = "job,id,strategy,scene,seed,taps,rmse_m,footprint_iou\n";
    for (int seed = 0; seed < kSeeds; ++seed) {
      for (const int object : {-1, 1}) {
        const double rmse = 0.001 * (10.0 + seed + 2.0 * object + worse(seed));
        text += fmt::format("0,x,default,s{},{},30,{},{}\n", object, seed, rmse, 0.5 + 0.1 * object + iou);
      }
    }
    write(here() / "build/results.csv", text);
  }
  void give_equal() const {
    give([](int) { return 0.0; });
  }
  Ended accuracy(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"/bin/sh", (here() / "tests/accuracy.sh").string(), (here() / "build").string(),
                                   "standard"};
    words.insert(words.end(), more.begin(), more.end());
    return test::run_program(words, here());
  }
};

TEST_F(Accuracy, FailsByThreeStandardErrorsOfTheDifferenceOfEachSeedWhateverSeedsDifferBy) {
  give_equal();
  ASSERT_EQ(accuracy({"--write"}).status, 0);
  // Differences of m + s and m - s: their mean is m, with a standard error of s / sqrt(11).
  const double spread = 1.0;
  const double limit = 3.0 * spread / std::sqrt(kSeeds - 1.0);
  const auto worse_by = [&](double mean) {
    give([&](int seed) { return mean + (seed % 2 == 0 ? spread : -spread); });
    return accuracy();
  };
  EXPECT_EQ(worse_by(0.99 * limit).status, 0);
  const Ended lost = worse_by(1.01 * limit);
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("accuracy: standard_30_default rmse_m: 15.50 mm -> 16.41 mm, worse by 0.91 mm, three "
                                  "standard errors of the difference being 0.90 mm (12 seeds)\n"));
  EXPECT_EQ(worse_by(-2.0 * limit).status, 0) << "better";
  give([](int) { return 0.0; }, -0.0024);
  EXPECT_EQ(accuracy().status, 0) << "less than 0.5 % of the value, although all seeds agree";
  give([](int) { return 0.0; }, -0.0026);
  EXPECT_THAT(accuracy().err, HasSubstr("standard_30_default iou: 0.500 -> 0.497"));
}

TEST_F(Accuracy, AValueThatIsMissingOrNotFiniteOrOfAnotherRecordFails) {
  give_equal();
  ASSERT_EQ(accuracy({"--write"}).status, 0);
  for (const char* value : {"nan", "inf", ""}) {
    give_equal();
    replace(here() / "build/results.csv", "30,0.011,", fmt::format("30,{},", value));
    const Ended ended = accuracy();
    EXPECT_EQ(ended.status, 1) << value;
    EXPECT_THAT(ended.err, HasSubstr("a run of standard_30_default,3 has no RMSE or IoU"));
  }
  give_equal();
  replace(here() / "tests/benchmark/accuracy.csv", "0.0155", "0.0255");
  EXPECT_THAT(accuracy().err, HasSubstr("short,standard_30_default,rmse_m: not the mean of its seeds"));
}

TEST_F(Accuracy, OfTheDefaultIsLostWithAWorseSetting) {
  if (test::brief()) GTEST_SKIP() << "./check --all makes it in release";
  const fs::path script = test::source_folder() / "tests/accuracy.sh";
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"/bin/sh", script.string(), test::program_file().parent_path().string()};
    words.insert(words.end(), more.begin(), more.end());
    return test::run_program(words, here());
  };
  const Ended worse = with({"standard", "--seeds", "6", "--set", "acquisition=uncertainty"});
  EXPECT_EQ(worse.status, 1) << worse.out;
  EXPECT_THAT(worse.err, HasSubstr("accuracy: standard_30_default rmse_m: "));
}

}  // namespace
}  // namespace palpate
