// SPDX-License-Identifier: MIT
// What a sweep survives: jobs that crash, are killed or fail, launchers that are killed, several at once, changed
// files.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <ostream>
#include <set>

namespace palpate {
namespace {

using test::eventually;

class Recovery : public Shell {
 protected:
  Recovery() { environment_ = {test::with_plugin("dies")}; }

  fs::path job(int index) const { return job_of(directory(), index); }
  std::string status() const { return status_of(directory()).out; }
  Ended resume(const Words& more = {}) const { return Shell::resume(directory(), more); }

  /// How often a job was begun.
  int attempts(int index) const { return lines(part_of(job(index), "attempt")); }

  /// A sweep over ways in which the process of a job ends in its fifth tap.
  Ended dying(const std::string& ways) const { return sweep("backend=dies --quiet backend.way=" + ways); }

  static std::string seeds(int jobs) { return "seed=range(0," + std::to_string(jobs) + ")"; }
  /// Jobs that take about a second each, by a pace of 0.006.
  static Words slow(int jobs, const std::string& pace = "0.006") {
    return {"sweep", paper(), seeds(jobs), "backend.pace=" + pace, "-j", "2", "--quiet"};
  }
  /// Some seconds each: where a signal has to find the first two under way, on a busy machine, too.
  static constexpr const char* kLong = "0.03";
  /// Begins such a sweep and waits until its first job has a tap.
  std::unique_ptr<test::Child> begun(int jobs, const std::string& pace = "0.006") const {
    auto child = begin(slow(jobs, pace));
    EXPECT_TRUE(eventually([&] { return pids().size() == 2 && !part_of(job(0), "tap").empty(); })) << child->err();
    return child;
  }
  /// Of the processes that began jobs.
  std::set<long> pids() const {
    std::set<long> out;
    std::error_code none;
    // Step by step, because folders get other names meanwhile.
    for (fs::recursive_directory_iterator at(here(), none), end; at != end; at.increment(none)) {
      if (at->path().filename() != "record.jsonl") continue;
      for (const Row& row : rows_of(at->path().parent_path(), "attempt")) {
        if (const Scalar* pid = row.find("pid")) out.insert(static_cast<long>(std::get<std::int64_t>(*pid)));
      }
    }
    return out;
  }
  /// Every job done, and no tap twice.
  void expect_done(int jobs) const {
    EXPECT_THAT(status(), StartsWith(std::to_string(jobs) + " jobs, " + std::to_string(jobs) + " done"));
    EXPECT_EQ(lines(text_of(directory() / "results.csv")), jobs + 1);
    for (int i = 0; i < jobs; ++i) EXPECT_EQ(lines(part_of(job(i), "tap")), 17);
  }
  /// The same, with the bytes of an unbroken sweep.
  void expect_whole(int jobs) const {
    expect_done(jobs);
    const fs::path unbroken = swept({seeds(jobs), "--runs", "unbroken"});
    for (int i = 0; i < jobs; ++i)
      EXPECT_TRUE(text_of(job(i) / "taps.csv") == text_of(job_of(unbroken, i) / "taps.csv")) << "job " << i;
  }
};

TEST_F(Recovery, ASweepWhoseDirectoryIsMovedOrRemovedStopsAndSaysWhatToDo) {
  for (const bool moved : {true, false}) {
    const auto child = begun(40);
    const fs::path before = directory();
    fs::rename(before, here() / "moved");
    if (!moved) fs::remove_all(here() / "moved");
    const Ended ended = child->wait();
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(ended.err, fs::relative(before, here()).string() +
                             ": was moved or removed while its jobs were running, run 'palpate resume' on its new "
                             "path, or start it again with 'palpate sweep'\n");
    EXPECT_FALSE(fs::exists(before)) << "nothing grows in its place";
    if (moved) {
      EXPECT_EQ(palpate("resume moved --quiet").status, 0);
      EXPECT_EQ(lines(text_of(here() / "moved" / "results.csv")), 41);
      fs::remove_all(here() / "moved");
    }
  }
}

TEST_F(Recovery, AJobThatCrashesOrLeavesNoResultCostsItselfAlone) {
  const Ended ended = dying("none,crash,exit,fail,leave");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("failed: job 1"), HasSubstr("crashed: signal 11 (Segmentation fault)"),
                    HasSubstr("failed: job 2"), HasSubstr("its process ended with status 3"),
                    HasSubstr("failed: job 3"), HasSubstr("backend.way=fail"), HasSubstr("its arm has fallen off"),
                    HasSubstr("failed: job 4"), HasSubstr("its process ended with status 0")));
  EXPECT_THAT(ended.out, HasSubstr("palpate resume --retry-failed"));
  EXPECT_THAT(status(), StartsWith("5 jobs, 1 done, 0 running, 4 failed"));
  EXPECT_EQ(lines(text_of(directory() / "results.csv")), 6) << "failed jobs are in the table, too";
  EXPECT_EQ(attempts(1), 1) << "it would crash again";
}

TEST_F(Recovery, AJobThatIsKilledIsBegunAgainButNotForEver) {
  const Ended ended = dying("none,kill");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("was killed by signal 9 (Killed), as happens when memory runs out, in attempt 3"));
  EXPECT_EQ(attempts(0), 1);
  EXPECT_EQ(attempts(1), 3);
  EXPECT_EQ(lines(part_of(job(1), "tap")), 4) << "what was tapped before is kept, and not tapped again";
  EXPECT_EQ(resume().status, 1);
  EXPECT_EQ(attempts(1), 3) << "a failed job is tried again on request only";
  EXPECT_EQ(resume("--retry-failed").status, 1);
  EXPECT_EQ(attempts(1), 6) << "whoever asks gets as many more";
  EXPECT_EQ(resume("--retry-failed --attempts 2").status, 1);
  EXPECT_EQ(attempts(1), 8);
}

TEST_F(Recovery, AKilledLauncherTakesItsJobsAlongAndResumeDoesTheRest) {
  const auto child = begun(5, kLong);
  child->signal(SIGKILL);
  child->wait();
  for (const long pid : pids()) EXPECT_TRUE(eventually([&] { return !test::running(pid); })) << pid;
  EXPECT_THAT(status(), HasSubstr("0 running"));
  ASSERT_EQ(resume().status, 0);
  expect_whole(5);
  int begun = 0;
  for (int i = 0; i < 5; ++i) begun += attempts(i);
  EXPECT_EQ(begun, 7) << "two were carried on, three begun once";
}

TEST_F(Recovery, AKilledJobIsCarriedOnAtOnce) {
  const auto child = begun(3, kLong);
  for (const long pid : pids()) ::kill(static_cast<pid_t>(pid), SIGKILL);
  EXPECT_EQ(child->wait().status, 0);
  expect_whole(3);
  EXPECT_EQ(attempts(0) + attempts(1) + attempts(2), 5);
}

TEST_F(Recovery, AnInterruptEndsTheTapsUnderWayAndLeavesTheRest) {
  const auto child = begun(5, kLong);
  child->signal(SIGINT);
  const Ended ended = child->wait();
  EXPECT_EQ(ended.status, 130);
  EXPECT_THAT(ended.out, HasSubstr("resume with: palpate resume"));
  EXPECT_THAT(status(), StartsWith("5 jobs, 0 done, 0 running, 0 failed, 2 unfinished, 3 missing"));
  EXPECT_THAT(part_of(job(0), "end"), HasSubstr("\"end\": \"interrupted\""));
  ASSERT_EQ(resume().status, 0);
  expect_done(5);
}

TEST_F(Recovery, AChangedConfigOfAJobFailsThatJobAndOneOfTheSweepRefusesItAll) {
  ASSERT_EQ(dying("none,fail").status, 1);
  test::forget_end(job(0));
  for (const char* name : {"summary.json", "record.jsonl"}) fs::remove(job(1) / name);
  replace(job(1) / "config.yaml", "taps: 17", "taps: 18");
  const Ended of_job = resume();
  EXPECT_EQ(of_job.status, 1);
  EXPECT_THAT(of_job.out, AllOf(HasSubstr("failed: job 1"), HasSubstr("config.yaml was changed")));
  EXPECT_EQ(attempts(0), 2) << "the other has run";
  EXPECT_EQ(attempts(1), 0);
  replace(job(1) / "config.yaml", "taps: 18", "taps: 17");
  EXPECT_EQ(resume("--retry-failed").status, 1) << "its arm falls off";
  EXPECT_EQ(attempts(1), 1);
  EXPECT_EQ(lines(part_of(job(1), "manifest")), 1);
  EXPECT_THAT(part_of(job(1), "manifest"), HasSubstr("\"build\": ")) << "it begins anew";

  replace(directory() / "config.yaml", "taps: 17", "taps: 18");
  EXPECT_THAT(refused({"resume", directory(), "--quiet"}), HasSubstr("was changed after this sweep started"));
  EXPECT_EQ(attempts(0), 2);
}

TEST_F(Recovery, SomeJobsAloneCanBeCarriedOn) {
  const auto child = begun(4);
  EXPECT_EQ(resume("--jobs 0").status, 75) << "another has it in hand, and nobody waits for it";
  child->signal(SIGKILL);
  child->wait();
  const Ended ended = resume("--jobs 1,3-3");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(attempts(2), 0);
  EXPECT_EQ(attempts(3), 1);
  EXPECT_THAT(status(), HasSubstr("2 done"));
  EXPECT_FALSE(fs::exists(directory() / "results.csv")) << "some are still missing";
  EXPECT_EQ(resume("--jobs 0-2").status, 0);
  expect_whole(4);
  for (const char* wrong : {"4", "1-", "2-1", "a", "1,,2", "-1", "1 2"}) {
    const Ended refused = resume({std::string("--jobs=") + wrong});
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_THAT(refused.err, HasSubstr("--jobs: ")) << wrong;
  }
  const Ended judged = resume("--jobs 0 --junit part.xml");
  EXPECT_EQ(judged.status, 2);
  EXPECT_THAT(judged.err, HasSubstr("--jobs and --junit exclude each other"));
}

TEST_F(Recovery, WhatExistsOnceIsMovedByOneJobAtATime) {
  environment_ = {test::with_plugin("cannot_go_on")};
  const Ended ended = sweep("backend=cannot_go_on taps=4 seed=range(0,3) -j 2");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("jobs run one at a time"), Not(HasSubstr("2 running"))));
}

/// How a sweep is begun: by a shell, or by whatever program this line of a shell names, in the place of $0.
struct Odd {
  const char* name;
  const char* shell;
  Words sweep;
  const char* done;
};

void PrintTo(const Odd& one, std::ostream* out) { *out << one.name; }

class OddSurroundings : public Recovery, public testing::WithParamInterface<Odd> {};

TEST_P(OddSurroundings, CostASweepNoJob) {
  const Words words{"/bin/sh", "-c", GetParam().shell, test::program_file(), "sweep", paper(), "taps=3"};
  const Ended ended = test::run_program(words + GetParam().sweep, here());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(status(), StartsWith(GetParam().done));
}

INSTANTIATE_TEST_SUITE_P(
    Of, OddSurroundings,
    testing::Values(
        // As on a terminal that was closed, every byte to stderr is an error.
        Odd{"NobodyReadsStderr", "exec \"$0\" \"$@\" 2>/dev/full", "-j 2 seed=range(0,20)", "20 jobs, 20 done"},
        Odd{"TheEndsOfChildrenAreIgnored",
            "exec python3 -SEc 'import os, signal, sys; signal.signal(signal.SIGCHLD, signal.SIG_IGN); "
            "os.execv(sys.argv[1], sys.argv[1:])' \"$0\" \"$@\"",
            "seed=range(0,4) --quiet", "4 jobs, 4 done"},
        Odd{"FilesRunShort", "ulimit -n 40; exec \"$0\" \"$@\"", "backend.pace=0.02 -j 200 seed=range(0,100) --quiet",
            "100 jobs, 100 done"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(Recovery, AJobWhoseFolderWasDeletedIsRunAgainByTheSweepWithItsConfig) {
  ASSERT_EQ(dying("none,exit").status, 1);
  const std::string config = text_of(job(0) / "config.yaml");
  fs::remove_all(job(0));
  EXPECT_THAT(resume().err, HasSubstr("it has no config.yaml"));
  EXPECT_EQ(dying("none,exit").status, 1);
  EXPECT_EQ(text_of(job(0) / "config.yaml"), config);
  EXPECT_EQ(palpate({"replay", job(0)}).status, 0);
}

}  // namespace
}  // namespace palpate
