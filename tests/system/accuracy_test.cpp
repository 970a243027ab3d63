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

  /// Jobs of a sweep: each strategy, object and seed.
  struct Jobs {
    std::vector<std::string> strategies{"default"};
    std::vector<int> objects{-1, 1};
    int seeds = kSeeds;
  };
  /// Results whose mean RMSE over the objects is 10 mm, more by 1 mm with every seed, and whose mean IoU is 0.5.
  /// `worse` is added to the RMSE of a seed, in millimetres, `iou` to all IoU.
  template <class Worse>
  void give(const Worse& worse, double iou, const Jobs& jobs) const {
    std::string text = "job,id,strategy,scene,seed,taps,rmse_m,footprint_iou\n";
    for (const std::string& strategy : jobs.strategies) {
      for (int seed = 0; seed < jobs.seeds; ++seed) {
        for (const int object : jobs.objects) {
          const double rmse = 0.001 * (10.0 + seed + 2.0 * object + worse(seed));
          text += fmt::format("0,x,{},s{},{},30,{},{}\n", strategy, object, seed, rmse, 0.5 + 0.1 * object + iou);
        }
      }
    }
    write(here() / "build/results.csv", text);
  }
  template <class Worse>
  void give(const Worse& worse, double iou = 0.0) const {
    give(worse, iou, Jobs());
  }
  void give_equal(const Jobs& jobs) const {
    give([](int) { return 0.0; }, 0.0, jobs);
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
  std::string table() const { return text_of(here() / "tests/benchmark/accuracy.csv"); }
};

TEST_F(Accuracy, IsRecordedOnceAsMeansOverSeedsWithTheirStandardErrors) {
  give_equal();
  const Ended unknown = accuracy();
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("accuracy/short.csv: record the short form by --write"));
  EXPECT_EQ(accuracy({"--write"}).status, 0);
  // The mean of 10 to 21 mm is 15.5, their variance (12^2 - 1) / 12 * 12 / 11 = 13, of the mean 13 / 12.
  EXPECT_EQ(table(), fmt::format("form,row,metric,seeds,value,standard_error,reason\n"
                                 "short,standard_30_default,rmse_m,12,0.0155,{:.3g},\n"
                                 "short,standard_30_default,iou,12,0.5,0,\n",
                                 0.001 * std::sqrt(13.0 / 12.0)));
  const Ended again = accuracy();
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("rmse_m  15.50 mm ->  15.50 mm  equal"));
}

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

TEST_F(Accuracy, TakesAWorseValueOnlyWithAReasonBesideIt) {
  give_equal();
  ASSERT_EQ(accuracy({"--write"}).status, 0);
  const std::string before = table();
  give([](int seed) { return seed == 3 ? 0.12 : 0.0; });  // far within three standard errors
  EXPECT_EQ(accuracy().status, 0);
  const Ended refused = accuracy({"--write"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("rmse_m: 15.50 mm -> 15.51 mm is worse: give the reason by --reason TEXT"));
  EXPECT_EQ(table(), before);
  EXPECT_EQ(accuracy({"--write", "--reason", "slower, but safe"}).status, 0);
  EXPECT_THAT(table(), HasSubstr("rmse_m,12,0.01551,"));
  EXPECT_THAT(table(), HasSubstr(",\"slower, but safe\"\nshort,standard_30_default,iou,12,0.5,0,\n"));
  EXPECT_EQ(accuracy().status, 0);
  EXPECT_EQ(accuracy({"--write"}).status, 0);
  EXPECT_THAT(table(), HasSubstr("slower, but safe")) << "the reason stays as long as the value";
  give_equal();
  EXPECT_EQ(accuracy({"--write"}).status, 0) << "what is better needs none";
  EXPECT_EQ(table(), before);
}

TEST_F(Accuracy, OfARecordedRowThatNoJobMakesAndOfAJobWithoutARowFails) {
  const Jobs two{{"default", "weighted"}};
  give_equal(two);
  ASSERT_EQ(accuracy({"--write"}).status, 0);
  const std::string before = table();
  give_equal();
  for (const char* mode : {"standard", "--write"}) {
    const Ended ended = accuracy({mode});
    EXPECT_EQ(ended.status, 1) << mode;
    EXPECT_EQ(ended.err,
              "accuracy: standard, seeds 60000 to 60029\n"
              "accuracy: short,standard_30_weighted is recorded, and no job makes it: give it up by --write "
              "--reason TEXT\n");
    EXPECT_EQ(table(), before);
  }
  EXPECT_EQ(accuracy({"--write", "--reason", "no longer of interest"}).status, 0);
  EXPECT_THAT(table(), HasSubstr("\nshort,standard_30_weighted,rmse_m,0,,,\"no longer of interest\"\n"
                                 "short,standard_30_weighted,iou,0,,,\"no longer of interest\"\n"));
  EXPECT_EQ(accuracy().status, 0);
  give_equal(two);
  const Ended unknown = accuracy();
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err,
              HasSubstr("accuracy: short,standard_30_weighted,rmse_m: not recorded: record it by --write\n"));
  EXPECT_EQ(accuracy({"--write"}).status, 0);
  EXPECT_EQ(table(), before);
}

TEST_F(Accuracy, OfOtherSeedsOrJobsFailsAndIsTakenOnlyWithAReasonBesideIt) {
  const auto recorded = [&](const Jobs& first, const Jobs& then, const std::string& says) {
    give_equal(first);
    fs::remove_all(here() / "tests/benchmark");
    ASSERT_EQ(accuracy({"--write"}).status, 0);
    const std::string before = table();
    give_equal(then);
    for (const char* mode : {"standard", "--write"}) {
      const Ended ended = accuracy({mode});
      EXPECT_EQ(ended.status, 1) << mode << says;
      EXPECT_THAT(ended.err, HasSubstr("accuracy: short,standard_30_default,rmse_m: " + says +
                                       ": record it by --write --reason TEXT\n"));
      EXPECT_EQ(table(), before);
    }
    EXPECT_EQ(accuracy({"--write", "--reason", "other runs"}).status, 0);
    EXPECT_THAT(table(), HasSubstr(fmt::format("short,standard_30_default,rmse_m,{},", then.seeds)));
    EXPECT_THAT(table(), HasSubstr(",\"other runs\"\nshort,standard_30_default,iou,"));
    EXPECT_EQ(accuracy().status, 0);
  };
  const Jobs usual;
  recorded(usual, {{"default"}, {-1, 1}, kSeeds + 1}, "seed 12 is not recorded");
  recorded(usual, {{"default"}, {-1, 1}, kSeeds - 1}, "12 -> 11 seeds");
  recorded(usual, {{"default"}, {-1, 0, 1}}, "2 -> 3 jobs of seed 0");
  recorded(usual, {{"default"}, {0}}, "2 -> 1 jobs of seed 0");
}

TEST_F(Accuracy, OfACommitThatMadeAValueWorseWithoutAReasonOrDeletedALineFails) {
  give_equal();
  ASSERT_EQ(accuracy({"--write"}).status, 0);
  const auto commit = [&] {
    return test::run_program({"/bin/sh", "-c", "git add tests && git -c user.name=a -c user.email=a@b commit -qm one"},
                             here(), {"HOME=" + here().string()});
  };
  if (test::run_program({"/bin/sh", "-c", "git init -q"}, here()).status != 0) GTEST_SKIP() << "no git";
  ASSERT_EQ(commit().status, 0);
  give([](int) { return 1.0; });
  ASSERT_EQ(accuracy({"--write", "--reason", "by choice"}).status, 0);
  const std::string with_reason = table();
  write(here() / "tests/benchmark/accuracy.csv", std::string(with_reason).erase(with_reason.find("\"by"), 11));
  ASSERT_EQ(commit().status, 0);
  const Ended ended = accuracy();
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("made short,standard_30_default,rmse_m worse, 0.0155 -> 0.0165, without a reason"));
  replace(here() / "tests/benchmark/accuracy.csv", "short,standard_30_default,iou,12,",
          "long,standard_30_default,iou,12,");
  ASSERT_EQ(commit().status, 0);
  EXPECT_THAT(accuracy().err,
              HasSubstr("deleted the line short,standard_30_default,iou: give it 0 seeds and a reason"));
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
