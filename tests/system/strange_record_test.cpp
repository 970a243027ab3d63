// SPDX-License-Identifier: MIT
// A record that somebody else has made may hold links to files of who reads it: no command writes through one. And a
// record that is taken away while it is written.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate {
namespace {

class AStrangeRecord : public Shell {
 protected:
  AStrangeRecord() { fs::create_directory(elsewhere_); }

  /// A link in the record to a file of the user.
  void link(const fs::path& name) const {
    fs::remove(name);
    fs::create_symlink(victim_, name);
  }

  void expect_unharmed() const {
    EXPECT_EQ(text_of(victim_), "mine");
    EXPECT_TRUE(fs::is_empty(elsewhere_));
  }

  static std::string refusal(const fs::path& link) {
    return link.string() + ": is a symbolic link, and links in a record are not followed, remove it\n";
  }

  fs::path victim_ = write("victim", "mine");
  fs::path elsewhere_ = here() / "elsewhere";
};

TEST_F(AStrangeRecord, IsReportedAndHasItsFiguresDrawnPastLinks) {
  const fs::path run = ran("taps=6");
  fs::create_directory(run / "figures");
  for (const char* name : {"report.html.tmp", "report.html", "figures/surface.png", "figures/surface.png.tmp",
                           "figures/surface.gnuplot", "figures/surface.gnuplot.tmp"}) {
    link(run / name);
  }
  for (const Words& words : {Words{"report", run}, Words{"report", run, "--figures"}}) {
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
  }
  EXPECT_FALSE(fs::is_symlink(run / "report.html"));
  EXPECT_THAT(text_of(run / "report.html"), EndsWith("</html>\n"));
  EXPECT_FALSE(fs::is_symlink(run / "figures" / "surface.png"));
  expect_unharmed();
}

TEST_F(AStrangeRecord, WhoseFiguresLieElsewhereIsRefused) {
  const fs::path run = ran("taps=6");
  fs::create_directory_symlink(elsewhere_, run / "figures");
  const Ended ended = palpate({"report", run, "--figures"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, refusal(run / "figures"));
  expect_unharmed();
}

TEST_F(AStrangeRecord, IsExportedThroughALinkOnlyWhereTheUserNamesIt) {
  const fs::path run = ran("taps=6");
  fs::create_directory_symlink(elsewhere_, run / "export");
  const Words words{"export", run, "--format", "ply"};
  const Ended ended = palpate(words);
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, refusal(run / "export"));
  expect_unharmed();
  EXPECT_EQ(palpate(words + Words{"--to", run / "export"}).status, 0);
  EXPECT_TRUE(fs::exists(elsewhere_ / "surface.ply"));
}

TEST_F(AStrangeRecord, IsNotCarriedOnThroughLinks) {
  const fs::path run = ran("taps=6");
  test::forget_end(run);
  link(run / "record.jsonl");
  const Ended ended = palpate({"resume", run});
  EXPECT_EQ(ended.err, refusal(run / "record.jsonl"));
  EXPECT_NE(ended.status, 0);
  expect_unharmed();
}

TEST_F(AStrangeRecord, IsNotWrittenToByAProgramThroughLinks) {
  const fs::path run = ran("taps=6 backend=process backend.command=true backend.repeatable=true");
  fs::remove(run / "summary.json");
  fs::remove(run / "record.jsonl");
  link(run / "process.stderr.txt");
  const Ended ended = palpate({"resume", run});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, EndsWith(refusal(run / "process.stderr.txt")));
  expect_unharmed();
}

TEST_F(AStrangeRecord, OfASweepIsNotCarriedOnThroughLinks) {
  const fs::path sweep = swept("seed=0,1 taps=4");
  const fs::path job = job_of(sweep, 0);
  fs::remove(job / "summary.json");
  link(job / "record.jsonl");
  const std::string said = refusal(job / "record.jsonl");
  EXPECT_THAT(resume(sweep).out, HasSubstr(said.substr(0, said.find(", remove it")))) << "it fails alone";
  expect_unharmed();
  fs::remove(job / "record.jsonl");
  fs::rename(job, here() / "job");
  fs::create_directory_symlink(here() / "job", job);
  EXPECT_THAT(resume(sweep).err, HasSubstr(refusal(job)));
  EXPECT_FALSE(fs::exists(here() / "job" / "summary.json"));
}

TEST_F(AStrangeRecord, ThatIsMovedAwayUnderItsRunStopsThatAtTheNextTapAndCanBeCarriedOn) {
  // A program that answers one tap after the record was moved away.
  write("arm.py",
        "import glob, json, os, sys\n"
        "for line in sys.stdin:\n"
        "    tap = json.loads(line)['tap']\n"
        "    if tap == 3 and not os.path.exists('moved'): os.rename(glob.glob('runs/*/*')[0], 'moved')\n"
        "    print(json.dumps({'tap': tap, 'outcome': 'contact', 'height': 0.0, 'seconds': 1.0}), flush=True)\n");
  EXPECT_THAT(refused({"run", paper(), "taps=6", "--quiet", "backend=process", "backend.command=python3 arm.py"}, 1),
              EndsWith(": was moved or removed while a run was writing there, run 'palpate resume' on its new path\n"));
  const Ended resumed = palpate("resume moved --quiet");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  const std::vector<std::string> made = outcomes(here() / "moved");
  EXPECT_EQ(made.size(), 6U);
  EXPECT_THAT(made, Not(testing::Contains("unknown"))) << "no tap was lost";
}

}  // namespace
}  // namespace palpate
