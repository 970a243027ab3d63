// SPDX-License-Identifier: MIT
// `palpate run` as a user calls it: what it prints, where, with which exit status, and what it leaves behind.
#include "record/files.hpp"
#include "record/json.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include <unistd.h>

namespace palpate {
namespace {

Scalar value(const std::string& json, const std::string& name) {
  const auto row = parse_json_row(json);
  EXPECT_TRUE(row) << json;
  const Scalar* found = row ? row->find(name) : nullptr;
  EXPECT_NE(found, nullptr) << name;
  return found != nullptr ? *found : Scalar{};
}

TEST(Run, PrintsALineATapAndASummaryAndLeavesEveryFileOfTheContract) {
  const TemporaryFolder folder;
  const Ended run = test::palpate({"run", paper()}, folder.path());
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(lines(run.out), 1 + 17 + 4);
  const fs::path directory = only_run(folder.path() / "runs");
  for (const char* name :
       {"config.yaml", "manifest.json", "taps.jsonl", "taps.csv", "timings.csv", "summary.json", "surface.csv"}) {
    EXPECT_TRUE(fs::exists(directory / name)) << name;
  }
  EXPECT_EQ(lines(text_of(directory / "taps.jsonl")), 17);
  EXPECT_EQ(lines(text_of(directory / "taps.csv")), 18);
  EXPECT_EQ(lines(text_of(directory / "timings.csv")), 18);
  EXPECT_EQ(lines(text_of(directory / "surface.csv")), 1 + 47 * 47);
  EXPECT_EQ(directory.parent_path().filename(), "object_i");
  EXPECT_EQ(directory.filename().string().size(), 12U);
}

TEST(Run, TheSummaryHoldsEveryFieldOfTheContractAndAddsUp) {
  const TemporaryFolder folder;
  const Ended run = test::palpate({"run", paper(), "--json"}, folder.path());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, text_of(only_run(folder.path() / "runs") / "summary.json"));
  for (const char* name : {"name",
                           "id",
                           "seed",
                           "status",
                           "stop_reason",
                           "taps",
                           "on_surface_taps",
                           "off_surface_taps",
                           "failed_taps",
                           "first_hit_tap",
                           "found",
                           "rmse_m",
                           "rmse_on_surface_m",
                           "rmse_height_m",
                           "footprint_iou",
                           "nlpd",
                           "coverage_95",
                           "robot_seconds",
                           "wall_seconds",
                           "compute_seconds",
                           "compute.infer",
                           "jitter_max",
                           "interventions.jitter",
                           "peak_rss_bytes"}) {
    value(run.out, name);
  }
  const auto whole = [&](const char* name) { return std::get<std::int64_t>(value(run.out, name)); };
  EXPECT_EQ(whole("taps"), 17);
  EXPECT_EQ(whole("on_surface_taps") + whole("off_surface_taps") + whole("failed_taps"), 17);
  EXPECT_EQ(value(run.out, "stop_reason"), Scalar{std::string("tap budget")});
}

TEST(Run, QuietPrintsNothing) {
  const TemporaryFolder folder;
  const Ended run = test::palpate({"run", paper(), "--quiet"}, folder.path());
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST(Run, DryRunSaysWhereAndLeavesNothing) {
  const TemporaryFolder folder;
  const Ended run = test::palpate({"run", paper(), "--dry-run"}, folder.path());
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("runs/object_i/"));
  EXPECT_THAT(run.out, HasSubstr("not run yet"));
  EXPECT_FALSE(fs::exists(folder.path() / "runs"));
}

TEST(Run, AFinishedRunIsReportedAndNotRepeated) {
  const TemporaryFolder folder;
  test::palpate({"run", paper()}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string before = text_of(directory / "summary.json");
  const Ended again = test::palpate({"run", paper()}, folder.path());
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.out, StartsWith("already done"));
  EXPECT_EQ(text_of(directory / "summary.json"), before);
}

TEST(Run, AFinishedRunOfAnotherBuildIsRefusedAndForceMovesItAside) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  std::string manifest = text_of(directory / "manifest.json");
  const auto build = manifest.find("\"build\": \"") + 10;
  manifest[build] = manifest[build] == '0' ? '1' : '0';
  std::ofstream(directory / "manifest.json") << manifest;

  const Ended refused = test::palpate({"run", paper()}, folder.path());
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("another build"));
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(lines(refused.err), 1);

  const Ended forced = test::palpate({"run", paper(), "--force"}, folder.path());
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_TRUE(fs::exists(directory.string() + ".old-1/summary.json"));
  EXPECT_TRUE(fs::exists(directory / "summary.json"));
}

TEST(Run, ThePrintedConfigRunsAsTheSameRun) {
  const TemporaryFolder folder;
  const Ended printed = test::palpate({"run", paper(), "kernel=matern52", "seed=4", "--print-config"}, folder.path());
  ASSERT_EQ(printed.status, 0) << printed.err;
  const fs::path file = folder.write("printed.yaml", printed.out);
  const Ended one = test::palpate({"run", paper(), "kernel=matern52", "seed=4", "--dry-run"}, folder.path());
  const Ended two = test::palpate({"run", file.string(), "--dry-run"}, folder.path());
  EXPECT_EQ(one.out, two.out);
  EXPECT_EQ(two.status, 0) << two.err;
}

TEST(Run, NamesEveryModelWithWhoReadsItInThePrintedConfigAndInTheManifest) {
  const TemporaryFolder folder;
  const auto models = [&](const std::vector<std::string>& words) {
    const std::vector<std::string> all = test::plus({"run", paper(), "--print-config"}, words);
    const std::string out = test::palpate(all, folder.path()).out;
    return out.substr(std::min(out.find("# models"), out.size()));
  };
  EXPECT_EQ(models({}),
            "# models that taps are chosen from, and who reads them:\n"
            "#   height process: acquisition weighted, fallback uncertainty, from its first use on\n"
            "#   weight process: acquisition weighted\n");
  EXPECT_EQ(models({"acquisition=random", "fallback=none"}), "");
  EXPECT_EQ(models({"acquisition=random", "fallback=none", "backend=adaptive"}),
            "# models that taps are chosen from, and who reads them:\n#   height process: backend simulator\n");
  EXPECT_THAT(
      test::palpate({"run", paper(), "kernel.length_scale=1e-300m", "scene.objects.0.at=[30cm,5cm]", "--print-config"},
                    folder.path())
          .out,
      HasSubstr("# this config cannot be run: "));

  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const std::string manifest = text_of(only_run(folder.path() / "runs") / "manifest.json");
  EXPECT_THAT(manifest, HasSubstr("\"models\": {\n    \"height process\": [\n      \"acquisition weighted\",\n"
                                  "      \"fallback uncertainty, from its first use on\"\n    ],\n"
                                  "    \"weight process\": [\n      \"acquisition weighted\"\n    ]\n  },"));
}

TEST(Run, OriginsTellWhereValuesCameFromAndWhatWasDropped) {
  const TemporaryFolder folder;
  const Ended run = test::palpate({"run", config("paper/comparison.yaml"), "acquisition=grid",
                                   "acquisition.type=random", "taps=9", "--print-config", "--origins"},
                                  folder.path());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("taps: 9"));
  EXPECT_THAT(run.out, ::testing::ContainsRegex("taps: 9 +# command line"));
  EXPECT_THAT(run.out, ::testing::ContainsRegex("# kernel rbf: .*configs/kernel/rbf.yaml\n"));
  EXPECT_THAT(run.out, ::testing::ContainsRegex("kernel.length_scale: 0.017 m +# .*configs/kernel/rbf.yaml:4:17"));
  EXPECT_THAT(run.out, ::testing::ContainsRegex("tie_tolerance: 1e-08 +# default"));
  EXPECT_THAT(run.out,
              ::testing::ContainsRegex("# dropped: acquisition.count from .*configs/acquisition/grid.yaml:4:10"));
}

TEST(Run, SwapsEveryStrategyFromTheCommandLine) {
  const TemporaryFolder folder;
  for (const char* choice :
       {"kernel=rbf", "kernel=matern32", "kernel=matern52", "acquisition=uncertainty", "acquisition=weighted",
        "acquisition=random", "acquisition=grid", "fitting=fixed", "scene=object_ii", "weight.clip=true",
        "height.kernel=matern32", "initial.design=sobol", "candidates={spacing: 1 cm}"}) {
    const Ended run = test::palpate({"run", paper(), choice, "--json", "--force"}, folder.path());
    EXPECT_EQ(run.status, 0) << choice << ": " << run.err;
    EXPECT_EQ(value(run.out, "taps"), Scalar{std::int64_t{17}}) << choice;
  }
}

TEST(Run, TheReplayBackendRepeatsARecordedRunFromItsTable) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path first = only_run(folder.path() / "runs");
  const Ended again = test::palpate(
      {"run", paper(), "backend={type: replay, record: " + first.string() + "}", "--runs", "again", "--quiet"},
      folder.path());
  ASSERT_EQ(again.status, 0) << again.err;
  const fs::path second = only_run(folder.path() / "again");
  const auto contacts = [](const fs::path& run) {
    std::string out;
    for (const Row& row : read_json_lines(run / "taps.jsonl").rows) {
      for (const char* name : {"x", "y", "outcome", "height", "score", "ties"}) out += csv_cell(*row.find(name)) + " ";
    }
    return out;
  };
  EXPECT_EQ(contacts(second), contacts(first));
}

TEST(Run, WritesTheMapsOfEachChoiceWhereTheConfigAsksForThem) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "log.maps=true", "--quiet"}, folder.path()).status, 0);
  const fs::path maps = only_run(folder.path() / "runs") / "maps";
  EXPECT_FALSE(fs::exists(maps / "tap_003.csv")) << "the initial taps are made without a model";
  EXPECT_THAT(text_of(maps / "tap_004.csv"), StartsWith("x,y,height_mean,height_variance,u,w\n"));
  EXPECT_EQ(lines(text_of(maps / "tap_017.csv")), 1 + 47 * 47);
}

TEST(Run, InterruptedInASimulationItEndsWith130AndResumedItEqualsTheUnbrokenOne) {
  const TemporaryFolder folder;
  const std::vector<std::string> run{"run", paper(), "backend.pace=0.2", "log.sync=tap", "taps=4"};
  const std::vector<std::string> words = test::plus({test::program_file().string()}, run);
  test::Child child(words, folder.path());
  // Waits for the first tap; the second takes more than a second: the signal falls into it.
  const fs::path runs = folder.path() / "runs" / "object_i";
  const auto tapped = [&] {
    std::error_code none;
    for (const auto& one : fs::directory_iterator(runs, none)) return !text_of(one.path() / "taps.jsonl").empty();
    return false;
  };
  for (int i = 0; i < 5000 && !tapped(); ++i) ::usleep(5000);
  child.signal(SIGINT);
  const Ended ended = child.wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("carry on: palpate resume"));
  const fs::path directory = only_run(folder.path() / "runs");
  EXPECT_FALSE(fs::exists(directory / "summary.json"));
  EXPECT_THAT(test::palpate({"status", directory.string()}, folder.path()).out, HasSubstr("unfinished after "));
  const Ended again = test::palpate(run, folder.path());
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("'palpate resume' carries on"));
  ASSERT_EQ(test::palpate({"resume", directory.string(), "--quiet"}, folder.path()).status, 0);
  ASSERT_EQ(test::palpate({"run", paper(), "taps=4", "--quiet", "--runs", "unbroken"}, folder.path()).status, 0);
  EXPECT_EQ(text_of(directory / "taps.jsonl"), text_of(only_run(folder.path() / "unbroken") / "taps.jsonl"))
      << "the tap that was broken off was made again, as if nothing had happened";
}

TEST(Run, ARunThatAnotherProcessHoldsEndsWith75) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  const FileLock lock(directory / "lock");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", paper(), "--force"}, {"resume", directory.string()}}) {
    fs::remove(directory / "summary.json");
    const Ended ended = test::palpate(words, folder.path());
    EXPECT_EQ(ended.status, 75) << words.front();
    EXPECT_THAT(ended.err, HasSubstr("another process holds this run"));
  }
  EXPECT_THAT(test::palpate({"status", directory.string()}, folder.path()).out, HasSubstr("running"));
}

}  // namespace
}  // namespace palpate
