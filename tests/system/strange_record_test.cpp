// SPDX-License-Identifier: MIT
// A record that somebody else has made may hold links to files of who reads it: no command writes through one. And a
// record that is taken away while it is written.
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include <sys/stat.h>

namespace palpate {
namespace {

class AStrangeRecord : public ::testing::Test {
 protected:
  Ended palpate(const std::vector<std::string>& words) const { return test::palpate(words, folder_.path()); }

  fs::path ran(const std::vector<std::string>& more = {}) const {
    const std::vector<std::string> words = test::plus({"run", paper(), "taps=6", "--quiet"}, more);
    EXPECT_EQ(palpate(words).err, "");
    return only_run(folder_.path() / "runs");
  }

  /// A link in the record to a file of the user.
  void link(const fs::path& name) const {
    fs::remove(name);
    fs::create_symlink(victim_, name);
  }

  void expect_unharmed() const {
    EXPECT_EQ(text_of(victim_), "mine");
    EXPECT_TRUE(fs::is_empty(elsewhere_));
  }

  std::string refusal(const fs::path& link) const {
    return link.string() + ": is a link, and nothing is written through one, remove it\n";
  }

  TemporaryFolder folder_;
  fs::path victim_ = folder_.write("victim", "mine");
  fs::path elsewhere_ = [this] {
    fs::create_directory(folder_.path() / "elsewhere");
    return folder_.path() / "elsewhere";
  }();
};

TEST_F(AStrangeRecord, IsReportedWithoutFollowingLinks) {
  const fs::path run = ran();
  link(run / "report.html.tmp");
  link(run / "report.html");
  EXPECT_EQ(palpate({"report", run.string()}).status, 0);
  EXPECT_FALSE(fs::is_symlink(run / "report.html"));
  EXPECT_THAT(text_of(run / "report.html"), EndsWith("</html>\n"));
  expect_unharmed();
}

TEST_F(AStrangeRecord, WhoseFiguresLieElsewhereIsRefused) {
  const fs::path run = ran();
  fs::create_directory_symlink(elsewhere_, run / "figures");
  const Ended ended = palpate({"report", run.string(), "--figures"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, refusal(run / "figures"));
  expect_unharmed();
}

TEST_F(AStrangeRecord, HasItsFiguresDrawnPastLinks) {
  const fs::path run = ran();
  fs::create_directory(run / "figures");
  for (const char* name : {"surface.png", "surface.png.tmp", "surface.gnuplot", "surface.gnuplot.tmp"}) {
    link(run / "figures" / name);
  }
  const Ended ended = palpate({"report", run.string(), "--figures"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_FALSE(fs::is_symlink(run / "figures" / "surface.png"));
  expect_unharmed();
}

TEST_F(AStrangeRecord, IsExportedThroughALinkOnlyWhereTheUserNamesIt) {
  const fs::path run = ran();
  fs::create_directory_symlink(elsewhere_, run / "export");
  const Ended ended = palpate({"export", run.string(), "--format", "ply"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, refusal(run / "export"));
  expect_unharmed();
  EXPECT_EQ(palpate({"export", run.string(), "--format", "ply", "--to", (run / "export").string()}).status, 0);
  EXPECT_TRUE(fs::exists(elsewhere_ / "surface.ply"));
}

TEST_F(AStrangeRecord, IsNotCarriedOnThroughLinks) {
  const fs::path run = ran();
  fs::remove(run / "summary.json");
  for (const char* name : {"taps.jsonl", "timings.csv", "lock"}) {
    const std::string kept = text_of(run / name);
    link(run / name);
    const Ended ended = palpate({"resume", run.string()});
    EXPECT_EQ(ended.err, refusal(run / name));
    EXPECT_NE(ended.status, 0) << name;
    expect_unharmed();
    fs::remove(run / name);
    folder_.write(fs::relative(run / name, folder_.path()).string(), kept);
  }
}

TEST_F(AStrangeRecord, IsNotWrittenToByAProgramThroughLinks) {
  const std::vector<std::string> program{"backend=process", "backend.command=true", "backend.repeatable=true"};
  const fs::path run = ran(program);
  fs::remove(run / "summary.json");
  fs::remove(run / "taps.jsonl");
  link(run / "process.stderr.txt");
  const Ended ended = palpate({"resume", run.string()});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, EndsWith(refusal(run / "process.stderr.txt")));
  expect_unharmed();
}

TEST_F(AStrangeRecord, OfASweepIsNotCarriedOnThroughLinks) {
  ASSERT_EQ(palpate({"sweep", paper(), "seed=0,1", "taps=4", "--quiet"}).status, 0);
  const fs::path sweep = only_run(folder_.path() / "runs");
  const auto rows = test::csv_rows(text_of(sweep / "results.csv"));
  const fs::path job = sweep / "jobs" / rows.front().at("id");
  fs::remove(job / "summary.json");
  link(job / "attempts.jsonl");
  EXPECT_THAT(palpate({"resume", sweep.string(), "--quiet"}).out, HasSubstr(refusal(job / "attempts.jsonl")))
      << "it fails alone";
  expect_unharmed();
  fs::remove(job / "attempts.jsonl");
  fs::remove(job / "summary.json");
  fs::rename(job, folder_.path() / "job");
  fs::create_directory_symlink(folder_.path() / "job", job);
  EXPECT_THAT(palpate({"resume", sweep.string(), "--quiet"}).err, HasSubstr(refusal(job)));
  EXPECT_FALSE(fs::exists(folder_.path() / "job" / "summary.json"));
}

TEST_F(AStrangeRecord, ThatIsMovedAwayUnderItsRunStopsThatAtTheNextTapAndCanBeCarriedOn) {
  // A program that answers one tap after the record was moved away.
  const fs::path moved = folder_.path() / "moved";
  const fs::path arm = folder_.write(
      "arm.py",
      "import glob, json, os, sys\n"
      "for line in sys.stdin:\n"
      "    tap = json.loads(line)['tap']\n"
      "    if tap == 3 and not os.path.exists('moved'): os.rename(glob.glob('runs/*/*')[0], 'moved')\n"
      "    print(json.dumps({'tap': tap, 'outcome': 'contact', 'height': 0.0, 'seconds': 1.0}), flush=True)\n");
  const Ended ended = palpate(
      {"run", paper(), "taps=6", "--quiet", "--runs", "runs", "backend=process", "backend.command=python3 arm.py"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, EndsWith(": was moved or removed while a run was writing there, where it was moved to, "
                                  "'palpate resume' carries on\n"));
  EXPECT_EQ(test::lines(ended.err), 1);
  const Ended resumed = palpate({"resume", moved.string(), "--quiet"});
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(test::lines(text_of(moved / "taps.csv")), 7);
  EXPECT_THAT(text_of(moved / "taps.csv"), ::testing::Not(HasSubstr("unknown"))) << "no tap was lost";
}

}  // namespace
}  // namespace palpate
