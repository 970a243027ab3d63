// SPDX-License-Identifier: MIT
// `palpate run` as a user calls it: what it prints, where, with which exit status, and what it leaves behind.
#include "record/files.hpp"
#include "record/json.hpp"
#include "support/lasting.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

namespace palpate {
namespace {

Scalar value(const std::string& text, const std::string& name) {
  const auto row = parse_json_row(text);
  EXPECT_TRUE(row) << text;
  const Scalar* found = row ? row->find(name) : nullptr;
  EXPECT_NE(found, nullptr) << name;
  return found != nullptr ? *found : Scalar{};
}

using ARun = Shell;

TEST_F(ARun, PrintsALineATapAndASummaryAndLeavesEveryFileOfTheContract) {
  const Ended ended = run();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(lines(ended.out), 1 + 17 + 4);
  for (const char* name : {"config.yaml", "record.jsonl", "summary.json"})
    EXPECT_TRUE(fs::exists(directory() / name)) << name;
  EXPECT_EQ(lines(part_of(directory(), "tap")), 17);
  EXPECT_EQ(lines(text_of(directory() / "taps.csv")), 18);
  EXPECT_EQ(lines(part_of(directory(), "timing")), 17);
  const auto entries = std::distance(fs::directory_iterator(directory()), fs::directory_iterator());
  EXPECT_EQ(entries, 5) << "config.yaml, record.jsonl, taps.csv, surface.csv, summary.json";
  EXPECT_EQ(lines(text_of(directory() / "surface.csv")), 1 + 47 * 47);
  EXPECT_EQ(directory().parent_path().filename(), "object_i");
  EXPECT_EQ(directory().filename().string().size(), 12U);
}

TEST_F(ARun, TheSummaryHoldsEveryFieldOfTheContractAndAddsUp) {
  const Ended ended = run("--json");
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, text_of(directory() / "summary.json"));
  for (const std::string& name :
       Words("name id seed status stop_reason taps object_taps desk_taps failed_taps first_hit_tap found "
             "rmse_m rmse_object_m rmse_height_m footprint_iou nlpd coverage_95 robot_seconds wall_seconds "
             "compute_seconds compute.infer jitter_max diagnostics.jitter peak_rss_bytes")) {
    value(ended.out, name);
  }
  const auto whole = [&](const char* name) { return std::get<std::int64_t>(value(ended.out, name)); };
  EXPECT_EQ(whole("taps"), 17);
  EXPECT_EQ(whole("object_taps") + whole("desk_taps") + whole("failed_taps"), 17);
  EXPECT_EQ(value(ended.out, "stop_reason"), Scalar{std::string("tap budget")});
}

TEST_F(ARun, DryRunSaysWhereAndLeavesNothing) {
  const Ended ended = run("--dry-run");
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, AllOf(HasSubstr("runs/object_i/"), HasSubstr("not run yet")));
  EXPECT_TRUE(left_nothing());
}

TEST_F(ARun, PrintsNothingIfQuietAndOnceFinishedIsReportedAndNotRepeated) {
  const fs::path directory = ran();
  const std::string before = text_of(directory / "summary.json");
  const Ended again = run();
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.out, StartsWith("already done"));
  EXPECT_EQ(text_of(directory / "summary.json"), before);
}

TEST_F(ARun, ThatAnotherBuildFinishedIsRefusedAndForceMovesItAside) {
  const fs::path directory = ran();
  make_of_another_build(directory);
  EXPECT_THAT(refused({"run", paper()}), AllOf(HasSubstr("another build"), HasSubstr("--force")));
  EXPECT_EQ(run("--force").status, 0);
  EXPECT_TRUE(fs::exists(directory.string() + ".old-1/summary.json"));
  EXPECT_TRUE(fs::exists(directory / "summary.json"));
}

TEST_F(ARun, ThePrintedConfigRunsAsTheSameRun) {
  const Words words = "kernel=matern52 seed=4";
  const fs::path file = write("printed.yaml", run(words + "--print-config").out);
  const Ended printed = run("--dry-run", file);
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.out, run(words + "--dry-run").out);
}

TEST_F(ARun, NamesEveryModelWithWhoReadsItInThePrintedConfigAndInTheManifest) {
  const auto models = [&](const Words& words) {
    const std::string out = run(Words{"--print-config"} + words).out;
    return out.substr(std::min(out.find("# models"), out.size()));
  };
  EXPECT_EQ(models({}),
            "# models for the choice of taps, and the parts that read them:\n"
            "#   height GP: acquisition weighted, fallback uncertainty, from its first use on\n"
            "#   label GP: acquisition weighted\n");
  EXPECT_EQ(models("acquisition=random choice.fallback=none"), "# models for the choice of taps: none\n");
  EXPECT_EQ(models("acquisition=random choice.fallback=none motion=adaptive"),
            "# models for the choice of taps, and the parts that read them:\n#   height GP: motion continuous\n");
  EXPECT_THAT(run("kernel.length_scale=1e-300m scene.objects.0.at=[30cm,5cm] --print-config").out,
              HasSubstr("# this config cannot be run: "));

  EXPECT_EQ(part_of(ran(), "setup"),
            "{\"setup\": 1, \"announces\": false, \"models\": {\"height GP\": [\"acquisition weighted\", "
            "\"fallback uncertainty, from its first use on\"], \"label GP\": [\"acquisition weighted\"]}}\n");
}

TEST_F(ARun, PrintingAConfigConnectsToNothing) {
  const fs::path built = here() / "built";
  environment_ = {test::with_plugin("connects"), "PALPATE_BUILT=" + built.string()};
  EXPECT_EQ(run("backend.type=connects --print-config").status, 0);
  EXPECT_FALSE(fs::exists(built));
}

TEST_F(ARun, ThatAnotherProcessTakesUpWhileItsBackendConnectsIsNotMovedAside) {
  const std::string built = (here() / "built").string();
  const std::string awaited = (here() / "awaited").string();
  environment_ = {test::with_plugin("connects")};
  const Words words = Words{"run", paper()} + "backend.type=connects taps=3 --quiet";
  ASSERT_EQ(palpate(words).status, 0);
  environment_ = {test::with_plugin("connects"), "PALPATE_BUILT=" + built, "PALPATE_AWAITED=" + awaited};
  const auto forced = begin(words + "--force");
  ASSERT_TRUE(test::eventually([&] { return fs::exists(built); }));
  const FileLock lock(directory() / "record.jsonl");
  write("awaited", "");
  const Ended ended = forced->wait();
  EXPECT_EQ(ended.status, 75);
  EXPECT_THAT(ended.err, HasSubstr("another process holds this run"));
  EXPECT_TRUE(fs::exists(directory() / "record.jsonl"));
}

TEST_F(ARun, OriginsTellWhereValuesCameFromAndWhatWasDropped) {
  const Ended ended =
      run("acquisition=grid acquisition.type=random taps=9 --print-config --origins", config("paper/comparison.yaml"));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, ContainsRegex("taps: 9 +# command line"));
  EXPECT_THAT(ended.out, ContainsRegex("# kernel rbf: .*configs/kernel/rbf.yaml\n"));
  EXPECT_THAT(ended.out, ContainsRegex("kernel.length_scale: 0.017 m +# .*configs/kernel/rbf.yaml:4:17"));
  EXPECT_THAT(ended.out, ContainsRegex("tie_tolerance: 1e-08 +# default"));
  EXPECT_THAT(ended.out, ContainsRegex("# dropped: acquisition.count from .*configs/acquisition/grid.yaml:4:10"));
}

TEST_F(ARun, WritesTheMapsOfEachChoiceWhereTheConfigAsksForThem) {
  const fs::path maps = ran("log.maps=true") / "maps";
  EXPECT_FALSE(fs::exists(maps / "tap_003.csv")) << "the initial taps are made without a model";
  EXPECT_THAT(text_of(maps / "tap_004.csv"), StartsWith("x,y,height_mean,height_standard_deviation,u,w\n"));
  EXPECT_EQ(lines(text_of(maps / "tap_017.csv")), 1 + 47 * 47);
}

TEST_F(ARun, InterruptedInASimulationItEndsWith130AndResumedItEqualsTheUnbrokenOne) {
  const Words words{"run", paper(), "backend.pace=0.2", "log.sync=tap", "taps=4"};
  const auto child = begin(words);
  // Waits for the first tap; the second takes more than a second: the signal falls into it.
  EXPECT_TRUE(test::eventually([&] {
    const fs::path begun = test::run_in(here() / "runs");
    return !begun.empty() && !part_of(begun, "tap").empty();
  }));
  child->signal(SIGINT);
  const Ended ended = child->wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("resume with: palpate resume"));
  EXPECT_FALSE(fs::exists(directory() / "summary.json"));
  EXPECT_THAT(status_of(directory()).out, HasSubstr("unfinished after "));
  EXPECT_THAT(refused(words), HasSubstr("resume it with 'palpate resume'"));
  ASSERT_EQ(resume(directory()).status, 0);
  EXPECT_EQ(part_of(directory(), "tap"), part_of(ran("taps=4 --runs unbroken"), "tap"))
      << "the tap that was broken off was made again, as if nothing had happened";
}

TEST_F(ARun, ThatAnotherProcessHoldsEndsWith75) {
  const fs::path directory = ran();
  test::forget_end(directory);
  const FileLock lock(directory / "record.jsonl");
  for (const Words& words : {Words{"run", paper(), "--force"}, Words{"resume", directory}})
    EXPECT_THAT(refused(words, 75), HasSubstr("another process holds this run"));
  EXPECT_THAT(status_of(directory).out, HasSubstr("running"));
}

}  // namespace
}  // namespace palpate
