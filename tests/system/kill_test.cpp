// SPDX-License-Identifier: MIT
// A run or a sweep that is killed at any moment, its jobs with it, loses no recorded tap, repeats none, and ends as the
// unbroken one does, in every file. PALPATE_KILLS says how many of each (tests/stress.sh: 150), each killed twice.
#include "record/json.hpp"
#include "support/lasting.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>

namespace palpate {
namespace {

using test::lasting_files;
using test::run_in;

// Robot time passes, a little of it, so that kills come within taps, too.
const std::vector<Words>& runs() {
  static const std::vector<Words> all{
      Words{"run", paper()} + "backend.pace=0.004",
      Words{"run", config("default.yaml")} + "scene=object_i taps=12 backend.pace=0.002 log.maps=true",
      Words{"run", paper()} + "backend.pace=0.002 fitting=ceres belief.height.signal=5cm fitting.every=4",
      Words{"run", paper()} +
          "backend.pace=0.002 taps=40 belief.surface=two_part acquisition=uncertainty stop.robot_time=120s"};
  return all;
}

/// Jobs side by side and one by one, with and without maps and fits.
const std::vector<Words>& sweeps() {
  static const std::vector<Words> all{
      Words{"sweep", paper()} + "name=killed acquisition=[weighted,uncertainty] seed=range(0,3) backend.pace=0.001",
      Words{"sweep", config("default.yaml")} + "name=killed scene=[object_i,object_ii] taps=6 backend.pace=0.001" +
          "log.maps=true log.surface=true -j 2",
      Words{"sweep", paper()} +
          "name=killed taps=[5,9] fitting=ceres belief.height.signal=5cm fitting.every=4 backend.pace=0.001 -j 1"};
  return all;
}

/// The recorded taps of a run: whole lines only, half a line at the end may go.
std::string complete_lines(const fs::path& runs) {
  const std::string text = part_of(run_in(runs), "tap");
  return text.substr(0, text.find_last_of('\n') + 1);
}

class KilledAgain : public testing::TestWithParam<int> {
 protected:
  /// Those of a test take turns among the commands.
  static void expect_same_files(const std::vector<Words>& commands) {
    const Words command = commands[static_cast<std::size_t>(GetParam()) % commands.size()] + "--quiet";
    SCOPED_TRACE(testing::PrintToString(command));
    const TemporaryFolder whole;
    const auto begin = std::chrono::steady_clock::now();
    const Ended unbroken = test::palpate(command, whole.path());
    ASSERT_EQ(unbroken.status, 0) << unbroken.err;
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;

    const TemporaryFolder folder;
    const fs::path runs = folder.path() / "runs";
    Random random(20, "kill_test", static_cast<std::uint64_t>(GetParam()));
    const auto moment = [&](double share) { return static_cast<int>(random.uniform() * share * took.count()); };
    // The command again if the kill came before there was anything to resume.
    const auto next = [&] {
      const fs::path directory = run_in(runs);
      const bool begun = !directory.empty() && fs::exists(directory / "config.yaml");
      return begun ? Words{"resume", directory, "--quiet"} : command;
    };
    // Every other first kill comes near the end, where the summary and the tables are written.
    test::run_and_kill(command, folder.path(),
                       GetParam() % 2 == 0 ? moment(1.0) : static_cast<int>(0.9 * took.count()) + moment(0.1));
    const std::string first = complete_lines(runs);
    // The second kill meets what is being carried on.
    test::run_and_kill(next(), folder.path(), moment(0.5));
    const std::string recorded = complete_lines(runs);
    EXPECT_EQ(recorded.substr(0, first.size()), first) << "what was recorded stays, line by line";
    const Ended last = test::palpate(next(), folder.path());
    EXPECT_EQ(last.status, 0) << last.err;
    EXPECT_EQ(lasting_files(run_in(runs)), lasting_files(run_in(whole.path() / "runs")));
    RecordProperty("recorded_before_the_last_resume", lines(recorded));
  }
};

using Kill = KilledAgain;
TEST_P(Kill, ResumedItEndsWithEveryFileAsTheUnbrokenRunHasIt) { expect_same_files(runs()); }
INSTANTIATE_TEST_SUITE_P(AtRandomMoments, Kill, testing::Range(0, test::wanted_kills(20, 8)));

using KillOfASweep = KilledAgain;
TEST_P(KillOfASweep, ResumedItEndsWithEveryFileAsTheUnbrokenSweepHasIt) { expect_same_files(sweeps()); }
INSTANTIATE_TEST_SUITE_P(AtRandomMoments, KillOfASweep, testing::Range(0, test::wanted_kills(12, 6)));

using KillWithinATap = Shell;

TEST_F(KillWithinATap, ThatCanBeRepeatedCostsNoTapHoweverTheLogIsSynced) {
  // It answers the second tap only once a file is there: the kill comes within it, however busy the machine is.
  const std::string arm = write("arm.py", test::python(R"(
parent = os.getppid()
for ask in asks():
    while ask["tap"] == 2 and not os.path.exists("go") and os.getppid() == parent: time.sleep(0.01)
    contact(ask)
)"));
  const auto child = begin({"run", config("process.yaml"), "backend.command=python3 -SE " + arm,
                            "backend.repeatable=true", "log.sync=tap", "taps=3"});
  const auto recorded = [&] {
    const fs::path run = run_in(here() / "runs");
    return run.empty() ? 0 : lines(part_of(run, "tap"));
  };
  EXPECT_TRUE(test::eventually([&] { return recorded() == 1; })) << child->err();
  child->signal(SIGKILL);
  child->wait();
  EXPECT_EQ(recorded(), 1);
  write("go", "");
  ASSERT_EQ(resume(directory()).status, 0);
  EXPECT_EQ(outcomes(directory()), std::vector<std::string>(3, "contact"));
}

}  // namespace
}  // namespace palpate
