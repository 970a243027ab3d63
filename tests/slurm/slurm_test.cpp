// SPDX-License-Identifier: MIT
// Sweeps on a cluster, as a user runs them: what is submitted, what runs, and that nothing runs twice.
#include "slurm_lab.hpp"

#include "support/parts.hpp"
#include "support/programs.hpp"
#include "sweep/sweep.hpp"
#include "system/shipped.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <numeric>

#include <unistd.h>

namespace palpate {
namespace {

using test::eventually;
using test::part_of;
using test::rows_of;
using test::SlurmLab;

/// A test that needs Slurm's daemons.
class Slurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = SlurmLab::missing(); !missing.empty()) GTEST_SKIP() << missing;
  }
};

Sweep sweep_in(const std::filesystem::path& folder) { return read_sweep(only_run(folder / "runs")); }

std::filesystem::path job_at(const Sweep& sweep, std::size_t job) { return job_directory(sweep, sweep.jobs[job]); }

/// The words with which README sends a sweep to a cluster, and `more`.
std::vector<std::string> on_slurm(std::vector<std::string> words, const std::vector<std::string>& more = {}) {
  words.insert(words.end(), {"--launcher", "slurm"});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// In a new cluster the first array has the number 2: 1 was that of the check before it.

// 85 s of robot time, and with them a job, take about two seconds.
constexpr const char* kPace = "backend.pace=0.02";

std::vector<int> attempts_in(const Sweep& sweep) {
  std::vector<int> out;
  for (const Job& job : sweep.jobs) out.push_back(lines(part_of(job_directory(sweep, job), "attempt")));
  return out;
}

int number_at(const Row& row, const char* name) { return static_cast<int>(row.number(name).value_or(-1.0)); }

/// The numbers of the recorded taps, in their order.
std::vector<int> taps_of(const fs::path& job) {
  std::vector<int> out;
  for (const Row& row : rows_of(job, "tap")) out.push_back(number_at(row, "tap"));
  return out;
}

std::vector<int> range(int first, int last) {
  std::vector<int> out(static_cast<std::size_t>(last - first) + 1);
  std::iota(out.begin(), out.end(), first);
  return out;
}

int recorded(const fs::path& job) { return lines(part_of(job, "tap")); }

/// The arrays that were submitted, as palpate says.
std::vector<int> arrays_in(const std::string& out) {
  std::vector<int> ids;
  const std::string word = "array ";
  for (std::size_t at = out.find(word); at != std::string::npos; at = out.find(word, at + 1))
    ids.push_back(std::stoi(out.substr(at + word.size())));
  return ids;
}

/// The parent of a process: of a job, the task that runs it.
int parent_of(int pid) {
  const std::string text = text_of("/proc/" + std::to_string(pid) + "/stat");
  return std::stoi(text.substr(text.find_last_of(')') + 4));
}

TEST_F(Slurm, OfAnArrayOnlyTheKilledJobIsSubmittedAgainAndNothingRunsTwice) {
  const SlurmLab lab;
  const Ended submitted = lab.palpate(on_slurm({"sweep", paper(), kPace, "scene.placement=random",
                                                "scene.objects.0.length=7cm,8cm,9cm,10cm,11cm,12cm,13cm,40cm"}));
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const Sweep sweep = sweep_in(lab.folder());
  const std::string directory = sweep.directory.string();
  EXPECT_THAT(submitted.out,
              AllOf(StartsWith("array 2: 8 tasks, 8 jobs, logs in " + directory + "/slurm/1\n"),
                    HasSubstr("palpate status " + directory + "\n"),
                    HasSubstr("palpate resume " + directory + " --launcher slurm\n"), HasSubstr("scancel 2\n")));
  constexpr std::size_t kVictim = 2;
  const fs::path victim = job_at(sweep, kVictim);
  ASSERT_TRUE(eventually([&] { return recorded(victim) >= 3; })) << text_of(sweep.directory / "slurm/1/2_2.log");
  const auto begun = rows_of(victim, "attempt");
  ASSERT_EQ(begun.size(), 1U);
  ASSERT_EQ(::kill(parent_of(number_at(begun.front(), "pid")), SIGKILL), 0);
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_EQ(lab.indices(2), range(0, 7));
  EXPECT_THAT(lab.palpate({"status", directory}).out,
              AllOf(StartsWith("8 jobs, 6 done, 0 running, 1 failed, 1 unfinished, 0 missing\n"),
                    HasSubstr("failed: job 7"), HasSubstr("does not fit into the area")));
  EXPECT_EQ(attempts_in(sweep), std::vector<int>(8, 1));
  EXPECT_FALSE(fs::exists(sweep.directory / "results.csv")) << "before all have ended";
  const std::string before = part_of(victim, "tap");

  const Ended resumed = lab.palpate(on_slurm({"resume", directory}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr(": 1 task, 1 job, logs in " + directory + "/slurm/2\n"));
  ASSERT_EQ(arrays_in(resumed.out).size(), 1U);
  // At the same time all of it by hand: those tasks find jobs that are done, failed or in other hands.
  const std::string script = (sweep.directory / "slurm/1/task.sh").string();
  const Ended twin = lab.run({"sbatch", "--parsable", "--array=0-7", "--output=/dev/null", script});
  ASSERT_EQ(twin.status, 0) << twin.err;
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_THAT(lab.indices(arrays_in(resumed.out).front()), ElementsAre(0));
  EXPECT_EQ(text_of(sweep.directory / "slurm/2/jobs"), fmt::format("{0}-{0}\n", kVictim));
  EXPECT_EQ(lab.indices(std::stoi(twin.out)), range(0, 7));
  EXPECT_EQ(attempts_in(sweep), (std::vector<int>{1, 1, 2, 1, 1, 1, 1, 1}));
  for (std::size_t job = 0; job < 7; ++job) EXPECT_EQ(taps_of(job_at(sweep, job)), range(1, 17)) << job;
  EXPECT_EQ(part_of(victim, "tap").substr(0, before.size()), before);
  const auto attempts = rows_of(victim, "attempt");
  ASSERT_EQ(attempts.size(), 2U);
  EXPECT_EQ(number_at(attempts[1], "after_tap"), lines(before));
  EXPECT_THAT(lab.palpate({"status", directory}).out, StartsWith("8 jobs, 7 done, 0 running, 1 failed, 0 unfinished"));
  EXPECT_EQ(lines(text_of(sweep.directory / "results.csv")), 1 + 8) << "left by the task that ended last";

  const Ended retried = lab.palpate(on_slurm({"resume", directory, "--retry-failed"}));
  ASSERT_EQ(arrays_in(retried.out).size(), 1U) << retried.err;
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_THAT(lab.indices(arrays_in(retried.out).front()), ElementsAre(0));
  EXPECT_EQ(text_of(sweep.directory / "slurm/3/jobs"), "7-7\n");
  EXPECT_EQ(attempts_in(sweep), (std::vector<int>{1, 1, 2, 1, 1, 1, 1, 2}));
  const Ended nothing = lab.palpate(on_slurm({"resume", directory}));
  EXPECT_EQ(nothing.status, 1) << "the failed job stays failed";
  EXPECT_THAT(nothing.out, HasSubstr("failed: job 7"));
  EXPECT_TRUE(arrays_in(nothing.out).empty());
}

TEST_F(Slurm, TasksRunSeveralJobsEachAndAnArrayIsSplitWhereTheClusterTakesNoMoreIndices) {
  test::SlurmSettings settings;
  settings.max_array_size = 4;
  const SlurmLab lab(settings);
  const Ended submitted = lab.palpate(
      on_slurm({"sweep", paper(), "seed=range(0,41)"}, {"--jobs-per-task", "4", "-j", "2", "--sbatch=--nice=3"}));
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const std::vector<int> arrays = arrays_in(submitted.out);
  ASSERT_EQ(arrays.size(), 3U) << submitted.out;
  const auto line = [&](std::size_t i, const char* counts) { return fmt::format("array {}: {},", arrays[i], counts); };
  EXPECT_THAT(submitted.out, AllOf(HasSubstr(line(0, "4 tasks, 16 jobs")), HasSubstr(line(1, "4 tasks, 16 jobs")),
                                   HasSubstr(line(2, "3 tasks, 9 jobs")),
                                   HasSubstr(fmt::format("scancel {}\n", fmt::join(arrays, " ")))));
  EXPECT_THAT(lab.run({"scontrol", "show", "job", std::to_string(arrays[2]), "-o"}).out,
              AllOf(HasSubstr("CPUs/Task=2"), HasSubstr("Nice=3"), HasSubstr("JobName=object_i ")));
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_EQ(lab.indices(arrays[0]), range(0, 3));
  EXPECT_EQ(lab.indices(arrays[1]), range(0, 3));
  EXPECT_EQ(lab.indices(arrays[2]), range(0, 2));
  for (const SlurmLab::Task& task : lab.tasks()) EXPECT_EQ(task.state, "COMPLETED") << task.array << "_" << task.index;
  const Sweep sweep = sweep_in(lab.folder());
  EXPECT_EQ(attempts_in(sweep), std::vector<int>(41, 1));
  EXPECT_EQ(lines(text_of(sweep.directory / "results.csv")), 1 + 41);
}

TEST_F(Slurm, WaitingItEndsAsASweepOnThisMachineDoes) {
  const SlurmLab lab;
  const std::vector<std::string> words{"sweep", paper(), "scene.placement=random",
                                       "scene.objects.0.length=10cm,16cm,40cm"};
  const Ended ended = lab.palpate(on_slurm(words, {"--wait", "--junit", "result.xml"}));
  EXPECT_EQ(ended.status, 1);
  std::vector<std::string> local = words;
  local.insert(local.end(), {"--runs", "local"});
  const Ended here = lab.palpate(local);
  EXPECT_EQ(here.status, 1);
  const auto table = [](const std::string& text) {
    const std::size_t begin = text.find("group ");
    return text.substr(begin, text.find("failed: job") - begin);
  };
  EXPECT_EQ(table(ended.out), table(here.out));
  EXPECT_THAT(ended.out, HasSubstr("failed: job 2"));
  EXPECT_THAT(text_of(lab.folder() / "result.xml"), HasSubstr("does not fit into the area"));

  const std::vector<std::string> good = on_slurm({"sweep", paper(), "seed=range(0,3)", "name=good"}, {"--wait"});
  const Ended fine = lab.palpate(good);
  EXPECT_EQ(fine.status, 0) << fine.err;
  EXPECT_THAT(fine.err, HasSubstr("3 of 3 jobs done"));
  const Ended again = lab.palpate(good);
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.out.find("array"), std::string::npos) << "nothing was missing";
}

TEST_F(Slurm, AJobThatFailedBeforeIsAwaitedUntilItHasBeenTriedAgain) {
  const SlurmLab lab;
  ASSERT_EQ(lab.palpate({"sweep", paper(), kPace, "seed=range(0,2)", "--quiet"}).status, 0);
  const Sweep sweep = sweep_in(lab.folder());
  const fs::path record = job_at(sweep, 1) / "record.jsonl";
  fs::resize_file(record, text_of(record).find("{\"tap\": 2"));
  test::set_end(job_at(sweep, 1), R"({"status": "failed", "stop_reason": "the arm was unplugged"})");
  const Ended ended = lab.palpate(on_slurm({"resume", sweep.directory.string(), "--retry-failed"}, {"--wait"}));
  EXPECT_EQ(ended.status, 0) << ended.out;
  EXPECT_THAT(lab.indices(2), ElementsAre(0));
  EXPECT_EQ(taps_of(job_at(sweep, 1)), range(1, 17));
}

TEST_F(Slurm, CtrlCCancelsWhatIsWaitedFor) {
  test::SlurmSettings settings;
  settings.cpus = 2;
  const SlurmLab lab(settings);
  const auto waiting = lab.start_palpate(on_slurm({"sweep", paper(), kPace, "seed=range(0,8)"}, {"--wait"}));
  ASSERT_TRUE(eventually([&] { return fs::exists(lab.folder() / "runs/object_i"); }));
  const Sweep sweep = sweep_in(lab.folder());
  ASSERT_TRUE(eventually([&] { return recorded(job_at(sweep, 0)) >= 1 && recorded(job_at(sweep, 1)) >= 1; }));
  waiting->signal(SIGINT);
  const Ended ended = waiting->wait(60);
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("resume with: palpate resume"));
  EXPECT_TRUE(lab.becomes_idle());
  const std::vector<int> attempts = attempts_in(sweep);
  EXPECT_EQ(std::accumulate(attempts.begin() + 2, attempts.end(), 0), 0) << "what waited did not begin";
  EXPECT_EQ(text_of(job_at(sweep, 0) / "record.jsonl").back(), '\n');
  EXPECT_THAT(part_of(job_at(sweep, 0), "end"), HasSubstr("\"end\": \"interrupted\"")) << "after its tap";
}

TEST_F(Slurm, ATerminalThatIsClosedEndsTheWaitingAndNotTheJobs) {
  const SlurmLab lab;
  const auto waiting = lab.start_palpate(on_slurm({"sweep", paper(), kPace, "seed=range(0,3)"}, {"--wait"}));
  ASSERT_TRUE(eventually([&] { return waiting->out().find("array 2") != std::string::npos; }));
  waiting->signal(SIGHUP);
  EXPECT_EQ(waiting->wait(60).status, 128 + SIGHUP);
  ASSERT_TRUE(lab.becomes_idle());
  const Sweep sweep = sweep_in(lab.folder());
  EXPECT_EQ(attempts_in(sweep), std::vector<int>(3, 1));
  EXPECT_EQ(lines(text_of(sweep.directory / "results.csv")), 1 + 3);
}

TEST_F(Slurm, FoldersMayHaveBlanksQuotesAndWhatShellsAndSlurmThinkSpecial) {
  const SlurmLab lab;
  const std::string name = R"(it's "my"  50%A $HOME; `a` & #1)";
  fs::create_directories(lab.folder() / name / "plugins");
  const Ended submitted =
      lab.palpate(on_slurm({"sweep", paper(), "seed=range(0,2)", "--runs", name}, {"--wait", "--sbatch=--export=NONE"}),
                  {"PALPATE_PLUGIN_PATH=" + name + "/plugins"});
  EXPECT_EQ(submitted.status, 0) << submitted.err << submitted.out;
  const Sweep sweep = read_sweep(only_run(lab.folder() / name));
  EXPECT_EQ(attempts_in(sweep), std::vector<int>(2, 1));
  EXPECT_TRUE(fs::exists(sweep.directory / "slurm/1/2_0.log"));
  EXPECT_EQ(text_of(sweep.directory / "slurm/1/2_1.log"), "");
}

TEST_F(Slurm, WhatCannotBeSubmittedIsSaidInOneLineAndNothingIsLeftInTheQueue) {
  const SlurmLab lab;
  const auto refused = [&](const std::vector<std::string>& more) {
    const Ended ended = lab.palpate(on_slurm({"sweep", paper(), "seed=range(0,2)", "--quiet"}, more));
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(lines(ended.err), 1);
    return ended.err;
  };
  EXPECT_THAT(refused({"--partition", "nope"}), StartsWith("sbatch: invalid partition specified: nope; "));
  EXPECT_THAT(refused({"--task-time", "soon"}), StartsWith("sbatch: "));
  EXPECT_THAT(refused({"--sbatch=--no-such-option"}), HasSubstr("--no-such-option"));
  EXPECT_THAT(refused({"--sbatch=--mem"}), StartsWith("sbatch: "));
  EXPECT_TRUE(lab.tasks().empty());
  EXPECT_EQ(attempts_in(sweep_in(lab.folder())), std::vector<int>(2, 0));
}

TEST_F(Slurm, ARaceGoesOnByItselfAndALostTaskDoesNotChangeItsDecisions) {
  const SlurmLab lab;
  const std::vector<std::string> words{
      "tune", paper(), kPace, "kernel.length_scale=2cm,3cm", "--metric", "rmse_m", "--jobs", "16", "--fresh", "5"};
  const Ended submitted = lab.palpate(on_slurm(words));
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const Sweep first = sweep_in(lab.folder());
  ASSERT_EQ(first.rounds.size(), 1U);
  EXPECT_EQ(first.jobs.size(), 12U) << "three settings on four seeds";
  const fs::path victim = job_at(first, 2);
  ASSERT_TRUE(eventually([&] { return recorded(victim) >= 3; }));
  ASSERT_EQ(::kill(parent_of(number_at(rows_of(victim, "attempt").front(), "pid")), SIGKILL), 0);
  const auto has_ended = [&] { return fs::exists(first.directory / "best.yaml"); };
  ASSERT_TRUE(eventually(has_ended)) << lab.run({"squeue"}).out;
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_EQ(lines(part_of(victim, "attempt")), 2) << "the killed job was submitted again";
  EXPECT_GE(sweep_in(lab.folder()).rounds.size(), 3U);

  std::vector<std::string> here = words;
  here.insert(here.end(), {"--runs", "here", "-j", "8"});
  ASSERT_EQ(lab.palpate(here).status, 0);
  const fs::path local = only_run(lab.folder() / "here");
  EXPECT_EQ(text_of(first.directory / "manifest.jsonl"), text_of(local / "manifest.jsonl"));
  EXPECT_EQ(text_of(first.directory / "best.yaml"), text_of(local / "best.yaml"));
}

TEST_F(Slurm, ARaceWhoseJobsDoNotEndStopsAndSaysHowToGoOn) {
  const SlurmLab lab;
  ASSERT_EQ(lab.palpate({"tune", paper(), "kernel.length_scale=2cm,3cm", "--metric", "rmse_m", "--jobs", "16",
                         "--fresh", "0", "-j", "8"})
                .status,
            0);
  const Sweep sweep = sweep_in(lab.folder());
  const fs::path victim = job_at(sweep, 2);
  const std::string directory = sweep.directory.string();
  const std::string whole = text_of(sweep.directory / "manifest.jsonl");
  std::ofstream(sweep.directory / "manifest.jsonl") << whole.substr(0, whole.find('\n', whole.find("{\"round\"")) + 1);
  for (const char* const file : {"record.jsonl", "summary.json"}) fs::remove(victim / file);
  {
    const RunDirectory held(victim);  // Every task finds the job busy and leaves it unfinished.
    ASSERT_EQ(lab.palpate(on_slurm({"resume", directory})).status, 0);
    ASSERT_TRUE(lab.becomes_idle()) << "it was submitted again and again";
  }
  EXPECT_FALSE(fs::exists(sweep.directory / "slurm/2")) << "nothing was submitted again";
  std::string logs;
  for (const auto& file : fs::directory_iterator(sweep.directory / "slurm/1")) logs += text_of(file.path());
  EXPECT_THAT(logs, HasSubstr("no job of the last submission has ended, so the race stops, read the logs in its folder "
                              "slurm, then run: palpate resume " +
                              directory + " --launcher slurm\n"));
  ASSERT_EQ(lab.palpate(on_slurm({"resume", directory})).status, 0) << "the remedy of the message";
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_EQ(text_of(sweep.directory / "manifest.jsonl"), whole);
}

TEST_F(Slurm, ARaceIsStoppedByTheNameThatAllItsJobsHave) {
  const SlurmLab lab;
  const Ended submitted = lab.palpate(
      on_slurm({"tune", paper(), kPace, "kernel.length_scale=2cm,3cm", "--metric", "rmse_m", "--jobs", "16"}));
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const fs::path directory = sweep_in(lab.folder()).directory;
  const std::string name = "--name=object_i_" + directory.filename().string();
  EXPECT_THAT(submitted.out, HasSubstr("\nstop: scancel " + name + "\n"));
  ASSERT_EQ(lab.run({"scancel", name}).status, 0);
  ASSERT_TRUE(lab.becomes_idle());
  EXPECT_FALSE(fs::exists(directory / "slurm/2"));
  EXPECT_EQ(sweep_in(lab.folder()).rounds.size(), 1U);
}

TEST_F(Slurm, WhatNoNodeCanRunNowIsSubmittedWithAWarning) {
  const SlurmLab lab;
  const Ended ended = lab.palpate(on_slurm({"sweep", paper(), "seed=range(0,2)", "--quiet"}, {"-j", "9"}));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(" now: allocation failure: Requested node configuration is not available; 'sinfo'"));
  EXPECT_FALSE(lab.tasks().empty());
}

}  // namespace
}  // namespace palpate
