// SPDX-License-Identifier: MIT
// What a sweep varies, described in a config and on the command line, as a user sees it.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

namespace palpate {
namespace {

class SweepDescription : public Shell {
 protected:
  /// What `--list` prints without job numbers and ids.
  Words listed(const Words& more, const std::string& file) const {
    const Ended ended = sweep(more + "--list", file);
    EXPECT_EQ(ended.status, 0) << ended.err;
    Words out;
    for (const std::string& line : lines_of(ended.out)) {
      const auto id = line.find("  ");
      out.push_back(line.substr(std::min(line.size(), line.find("  ", id + 2) + 2)));
    }
    return out;
  }
};

TEST_F(SweepDescription, RunsEveryBlockOfAConfigAndLeavesCellsEmptyWhereAnOptionIsMissing) {
  write("mine.yaml",
        "name: mine\n"
        "defaults:\n"
        "  - kernel: rbf\n"
        "  - acquisition: weighted\n"
        "  - fitting: fixed\n"
        "  - backend: simulator\n"
        "  - scene: object_i\n"
        "sweep:\n"
        "  zip: {taps: [6, 8], candidates.count: [12, 24]}\n"
        "  list:\n"
        "    - acquisition: random\n"
        "    - {acquisition: grid, acquisition.count: [3, 4]}\n"
        "  sobol: {samples: 2, keys: {kernel.length_scale: 'log_uniform(1cm,10cm)'}}\n"
        "  grid: {seed: [1, 2]}\n"
        "  where: [taps == 8 or not acquisition == grid, seed == 1 or taps < 8]\n");
  // Of 2 x 3 x 2 x 2: with 6 taps random alone, 2 x 2; with 8 all three, with one seed.
  const std::string results = text_of(swept({}, "mine.yaml") / "results.csv");
  const auto rows = csv_rows(results);
  ASSERT_EQ(rows.size(), 4U + 6U);
  for (const Cells& row : rows) {
    EXPECT_EQ(row.at("candidates.count"), row.at("taps") == "6" ? "12" : "24");
    EXPECT_EQ(row.at("acquisition.count").empty(), row.at("acquisition") == "random");
    EXPECT_EQ(row.at("status"), "done");
  }
  EXPECT_THAT(results, HasSubstr("job,id,taps,candidates.count,acquisition,acquisition.count,kernel.length_scale,"
                                 "seed,name"));
}

TEST_F(SweepDescription, LeavesAConfigThatIsTheSameSweep) {
  for (const Words& words :
       {Words{"sweep.zip={taps: [6, 8], candidates.count: [12, 24]}", "seed=1,2"},
        Words{"sweep.list=[{acquisition: random}, {acquisition: grid, acquisition.count: [3, 4]}]", "taps=6"},
        Words{"sweep.sobol={samples: 3, keys: {kernel.length_scale: 'log_uniform(1cm,10cm)'}}", "taps=6"},
        Words{"kernel=rbf,rational_quadratic", "kernel.alpha=1,2", "taps=6", "sweep.where=not kernel.alpha == 2"}}) {
    const fs::path directory = swept(words);
    const fs::path other = swept("--runs again", directory / "config.yaml");
    EXPECT_EQ(other.filename(), directory.filename());
    const std::vector<fs::path> jobs = jobs_of(directory);
    EXPECT_EQ(jobs_of(other).size(), jobs.size());
    for (const fs::path& job : jobs) EXPECT_TRUE(fs::exists(other / "jobs" / job.filename())) << words.front();
    EXPECT_EQ(text_of(other / "config.yaml"), text_of(directory / "config.yaml"));
    EXPECT_EQ(text_of(other / "manifest.jsonl"), text_of(directory / "manifest.jsonl"));
  }
}

TEST_F(SweepDescription, NarrowsTheSweepOfAConfigFromTheCommandLine) {
  Words expected;
  for (const char* taps : {"taps=17", "taps=19"}) {
    for (const char* scale : {"2.5 cm", "4 cm"}) {
      expected.push_back(std::string(taps) + "  kernel=rational_quadratic  kernel.length_scale=" + scale +
                         "  kernel.alpha=0.5  seed=3  scene=object_i");
    }
  }
  EXPECT_EQ(listed({"seed=3", "scene=object_i", "sweep.where=kernel.alpha < 1"}, config("sweep/kernels.yaml")),
            expected);
}

struct Wrong {
  const char* name;
  Words words;
  std::string message;
};

void PrintTo(const Wrong& one, std::ostream* out) { *out << one.name; }

class WrongSweep : public Shell, public testing::WithParamInterface<Wrong> {};

TEST_P(WrongSweep, IsRefusedInOneLineBeforeAnythingRuns) {
  EXPECT_EQ(refused(Words{"sweep", paper()} + GetParam().words), "command line: " + GetParam().message + "\n");
  EXPECT_TRUE(left_nothing());
}

INSTANTIATE_TEST_SUITE_P(
    Of, WrongSweep,
    testing::Values(
        Wrong{"AZipOfUnlikeLengths",
              {"sweep.zip={taps: [12, 17], seed: [1, 2, 3]}"},
              "sweep.zip: 'seed' has 3 values, 'taps' has 2, give all keys the same number of values, or combine them "
              "in 'grid'"},
        Wrong{"AConditionThatNothingFulfils",
              {"taps=12,17", "sweep.where=taps > 20"},
              "sweep.where: matches none of the 2 combinations, relax the condition, or sweep other values"},
        Wrong{"AConditionCutShort",
              {"taps=12,17", "sweep.where=taps >"},
              "the condition 'taps >': a value is missing after 'taps >', write it like taps >= 12 and not surface == "
              "two_part"},
        Wrong{"EndsOfUnlikeUnits",
              {"sweep.sobol={samples: 4, keys: {height.noise: 'uniform(0.1 mm, 1 cm)'}}"},
              "height.noise: 'uniform(0.1 mm, 1 cm)' has ends with different units, write uniform(0.1 mm, 1 mm) or "
              "log_uniform(1 cm, 10 cm), both ends with the same unit"},
        Wrong{"AnOptionThatNoJobHas", "acquisition=weighted,grid acquisition.conut=3,4",
              "no job of the sweep has an option 'acquisition.conut', did you mean 'count'?"},
        Wrong{"AnUnknownBlock", "sweep.sobl={}", "unknown option 'sobl' of sweep, did you mean 'sobol'?"},
        Wrong{"MillionsOfJobs", "seed=range(0,2000) taps=range(3,1000)",
              "taps: the sweep has more than a million jobs, use fewer values"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(SweepDescription, WithAKeyInTwoBlocksIsRefusedWithBothPlaces) {
  write("twice.yaml", "sweep:\n  grid: {seed: [1, 2]}\n  zip: {seed: [1, 2]}\n");
  EXPECT_EQ(refused("sweep twice.yaml"),
            "twice.yaml:3:16: 'seed' is in sweep.zip and, at twice.yaml:2:17, in sweep.grid, write each key in one "
            "block only\n");
}

TEST_F(SweepDescription, OfAShippedConfigRunsToItsEnd) {
  const Ended ended = sweep("seed=1", config("sweep/kernels.yaml"));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(lines(text_of(directory() / "results.csv")), 1 + 2 * (3 + 2 + 2 + 4));
  EXPECT_THAT(ended.out, Not(HasSubstr("kernel.alpha= "))) << "what a setting does not have is not shown";
}

TEST_F(SweepDescription, ASingleRunLeavesItAsideAndSaysSo) {
  const Words words{"taps=5", "sweep.grid={seed: [1, 2]}"};
  const Ended ended = run(words);
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "command line: sweep: is ignored by 'palpate run'; 'palpate sweep' runs all its jobs\n");
  EXPECT_EQ(run(words + "--quiet").err, "");
  EXPECT_EQ(run("taps=6").err, "");
}

}  // namespace
}  // namespace palpate
