// SPDX-License-Identifier: MIT
// What a sweep varies, described in a config and on the command line, as a user sees it.
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace palpate {
namespace {

using Words = std::vector<std::string>;

/// What `--list` prints without job numbers and ids.
Words listed(const Words& words, const TemporaryFolder& folder) {
  Words all{"sweep"};
  all.insert(all.end(), words.begin(), words.end());
  all.push_back("--list");
  const Ended ended = test::palpate(all, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  Words out;
  for (std::size_t from = 0; from < ended.out.size();) {
    const auto end = ended.out.find('\n', from);
    const std::string line = ended.out.substr(from, end - from);
    const auto id = line.find("  ");
    out.push_back(line.substr(std::min(line.size(), line.find("  ", id + 2) + 2)));
    from = end + 1;
  }
  return out;
}

std::string refused(const Words& words, const TemporaryFolder& folder) {
  Words all{"sweep"};
  all.insert(all.end(), words.begin(), words.end());
  const Ended ended = test::palpate(all, folder.path());
  EXPECT_EQ(ended.status, 2) << ended.out;
  EXPECT_EQ(lines(ended.err), 1) << "one line says it";
  EXPECT_FALSE(fs::exists(folder.path() / "runs") && !fs::is_empty(folder.path() / "runs")) << "nothing is left behind";
  return ended.err;
}

std::set<std::string> jobs_in(const fs::path& directory) {
  std::set<std::string> out;
  for (const auto& job : fs::directory_iterator(directory / "jobs")) out.insert(job.path().filename().string());
  return out;
}

TEST(SweepDescription, RunsEveryBlockOfAConfigAndLeavesCellsEmptyWhereAnOptionIsMissing) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("mine.yaml",
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
                                     "  sobol: {samples: 2, keys: {kernel.length_scale: 'log(1cm,10cm)'}}\n"
                                     "  grid: {seed: [1, 2]}\n"
                                     "  where: [taps == 8 or not acquisition == grid, seed == 1 or taps < 8]\n");
  // Of 2 x 3 x 2 x 2: with 6 taps random alone, 2 x 2; with 8 all three, with one seed.
  const Ended ended = test::palpate({"sweep", file.string(), "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const fs::path directory = only_run(folder.path() / "runs");
  const auto rows = test::csv_rows(text_of(directory / "results.csv"));
  ASSERT_EQ(rows.size(), 4U + 6U);
  for (const test::Cells& row : rows) {
    EXPECT_EQ(row.at("candidates.count"), row.at("taps") == "6" ? "12" : "24");
    EXPECT_EQ(row.at("acquisition.count").empty(), row.at("acquisition") == "random");
    EXPECT_EQ(row.at("status"), "done");
  }
  EXPECT_THAT(text_of(directory / "results.csv"),
              HasSubstr("job,id,taps,candidates.count,acquisition,acquisition.count,kernel.length_scale,seed,name"));
}

TEST(SweepDescription, LeavesAConfigThatIsTheSameSweep) {
  const TemporaryFolder folder;
  for (const Words& words :
       {Words{"sweep.zip={taps: [6, 8], candidates.count: [12, 24]}", "seed=1,2"},
        Words{"sweep.list=[{acquisition: random}, {acquisition: grid, acquisition.count: [3, 4]}]", "taps=6"},
        Words{"sweep.sobol={samples: 3, keys: {kernel.length_scale: 'log(1cm,10cm)'}}", "taps=6"},
        Words{"kernel=rbf,rational_quadratic", "kernel.alpha=1,2", "taps=6", "sweep.where=not kernel.alpha == 2"}}) {
    const TemporaryFolder here;
    Words all{"sweep", paper(), "--quiet"};
    all.insert(all.end(), words.begin(), words.end());
    ASSERT_EQ(test::palpate(all, here.path()).status, 0);
    const fs::path directory = only_run(here.path() / "runs");
    const Ended again =
        test::palpate({"sweep", (directory / "config.yaml").string(), "--runs", "again", "--quiet"}, here.path());
    ASSERT_EQ(again.status, 0) << again.err;
    const fs::path other = only_run(here.path() / "again");
    EXPECT_EQ(jobs_in(other), jobs_in(directory)) << words.front();
    EXPECT_EQ(other.filename(), directory.filename());
    EXPECT_EQ(text_of(other / "config.yaml"), text_of(directory / "config.yaml"));
    EXPECT_EQ(text_of(other / "manifest.jsonl"), text_of(directory / "manifest.jsonl"));
  }
}

TEST(SweepDescription, NarrowsTheSweepOfAConfigFromTheCommandLine) {
  const TemporaryFolder folder;
  const std::string kernels = test::config("sweep/kernels.yaml");
  EXPECT_THAT(listed({kernels, "seed=3", "scene=object_i", "sweep.where=kernel.alpha < 1"}, folder),
              ElementsAre("taps=17  kernel=rational_quadratic  kernel.length_scale=2.5 cm  kernel.alpha=0.5  seed=3  "
                          "scene=object_i",
                          "taps=17  kernel=rational_quadratic  kernel.length_scale=4 cm  kernel.alpha=0.5  seed=3  "
                          "scene=object_i",
                          "taps=19  kernel=rational_quadratic  kernel.length_scale=2.5 cm  kernel.alpha=0.5  seed=3  "
                          "scene=object_i",
                          "taps=19  kernel=rational_quadratic  kernel.length_scale=4 cm  kernel.alpha=0.5  seed=3  "
                          "scene=object_i"));
}

TEST(SweepDescription, SaysWhatIsWrongInOneLineBeforeAnythingRuns) {
  const TemporaryFolder folder;
  EXPECT_EQ(refused({paper(), "sweep.zip={taps: [12, 17], seed: [1, 2, 3]}"}, folder),
            "command line: sweep.zip: 'seed' has 3 values, 'taps' has 2, give every key as many, or multiply them in "
            "'grid'\n");
  EXPECT_EQ(
      refused({paper(), "taps=12,17", "sweep.where=taps > 20"}, folder),
      "command line: sweep.where: it holds for none of the 2 combinations, ask for less, or sweep other values\n");
  EXPECT_EQ(
      refused({paper(), "taps=12,17", "sweep.where=taps >"}, folder),
      "command line: the condition 'taps >': behind 'taps >' a value is missing, write it like taps >= 12 and not "
      "surface == two_part\n");
  EXPECT_EQ(
      refused({paper(), "sweep.sobol={samples: 4, keys: {height.noise: 'uniform(0.1 mm, 1 cm)'}}"}, folder),
      "command line: height.noise: the ends of 'uniform(0.1 mm, 1 cm)' have unlike units, write uniform(0.1 mm, 1 "
      "mm) or log(1cm, 10cm), both ends with the same unit\n");
  EXPECT_EQ(refused({paper(), "acquisition=weighted,grid", "acquisition.conut=3,4"}, folder),
            "command line: no job of the sweep has an option 'acquisition.conut', did you mean 'count'?\n");
  EXPECT_EQ(refused({paper(), "sweep.sobl={}"}, folder),
            "command line: unknown option 'sobl' of sweep, did you mean 'sobol'?\n");
  EXPECT_EQ(refused({paper(), "seed=range(0,2000)", "taps=range(3,1000)"}, folder),
            "command line: taps: the sweep has more than a million jobs, take fewer values\n");
  const fs::path file = folder.write("twice.yaml", "sweep:\n  grid: {seed: [1, 2]}\n  zip: {seed: [1, 2]}\n");
  EXPECT_EQ(refused({file.string()}, folder), file.string() + ":3:16: 'seed' stands in sweep.zip and, at " +
                                                  file.string() +
                                                  ":2:17, in sweep.grid, a key may stand in one block only\n");
}

TEST(SweepDescription, OfAShippedConfigRunsToItsEnd) {
  const TemporaryFolder folder;
  const Ended ended = test::palpate({"sweep", test::config("sweep/kernels.yaml"), "seed=1"}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(lines(text_of(only_run(folder.path() / "runs") / "results.csv")), 1 + 2 * (3 + 2 + 2 + 4));
  EXPECT_THAT(ended.out, Not(HasSubstr("kernel.alpha= "))) << "what a setting does not have is not shown";
}

TEST(SweepDescription, ASingleRunLeavesItAsideAndSaysSo) {
  const TemporaryFolder folder;
  const Words run{"run", paper(), "taps=5", "sweep.grid={seed: [1, 2]}"};
  const Ended ended = test::palpate(run, folder.path());
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "command line: sweep: is left aside, one experiment is run; 'palpate sweep' runs them all\n");
  Words quiet = run;
  quiet.push_back("--quiet");
  EXPECT_EQ(test::palpate(quiet, folder.path()).err, "");
  EXPECT_EQ(test::palpate({"run", paper(), "taps=6"}, folder.path()).err, "");
}

}  // namespace
}  // namespace palpate
