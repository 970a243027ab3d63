// SPDX-License-Identifier: MIT
// The launcher for Slurm: its calls of Slurm's commands and its reading of their output, without Slurm.
#include "launch/slurm_launcher.hpp"

#include "launch/slurm.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <sstream>

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace fs = std::filesystem;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(line);
  return out;
}

TEST(SlurmLimits, AreReadFromTheConfigOfTheController) {
  EXPECT_EQ(slurm::parse_most_tasks("Configuration data\nMaxArraySize            = 1001\nMaxJobCount = 10000\n"), 1001);
  EXPECT_EQ(slurm::parse_most_tasks("MaxArraySize            = 100001\n"
                                    "SchedulerParameters     = bf_interval=1,max_array_tasks=500,defer\n"),
            500);
  EXPECT_EQ(slurm::parse_most_tasks("max_array_tasks=5000\nMaxArraySize=100"), 100);
  for (const char* text : {"", "MaxArraySize =", "MaxArraySize = -1", "MaxArraySize = 99999999999999"})
    EXPECT_THROW(slurm::parse_most_tasks(text), Error) << text;
  EXPECT_THAT(test::error_of([] { slurm::parse_most_tasks("MaxArraySize = 1"); }),
              HasSubstr("this cluster accepts no job arrays"));
}

TEST(SlurmQueue, IsReadByTaskAndGarbageIsSkipped) {
  const auto tasks =
      slurm::parse_queue("CLUSTER: far\n7 R\n8 PD\n9\n\nN/A R\nx 1 R\n99999999999999 R\n" + std::string(100000, ' '));
  ASSERT_EQ(tasks.size(), 2U);
  EXPECT_EQ(tasks[0].array, 7);
  EXPECT_FALSE(tasks[0].waiting);
  EXPECT_EQ(tasks[1].array, 8);
  EXPECT_TRUE(tasks[1].waiting);
}

TEST(SlurmArrayId, IsFoundAmongWhatASiteHasToSay) {
  EXPECT_EQ(slurm::parse_array_id("123;cluster\n"), 123);
  EXPECT_EQ(slurm::parse_array_id("sbatch: warning: 5 hours will be charged\n123\nsbatch: thank you\n"), 123);
  for (const char* text : {"", "Submitted batch job 5", "12x", "-4", "99999999999999"})
    EXPECT_EQ(slurm::parse_array_id(text), std::nullopt) << text;
}

TEST(SlurmWords, AreOneLine) {
  EXPECT_EQ(slurm::words_of("sbatch: error: invalid partition specified: nope\nsbatch: error: Batch job submission "
                            "failed: Invalid partition name specified\n"),
            "invalid partition specified: nope; Batch job submission failed: Invalid partition name specified");
  EXPECT_EQ(slurm::words_of("\n  \n"), "failed without a message");
}

TEST(ShellWord, IsReadByAShellAsItWas) {
  const test::TemporaryFolder folder;
  for (const char* word : {"plain/path-1.2", "", " ", "a  b", "it's", "''", "$HOME", "`ls`", "a\nb", "\\", "~", "*",
                           "-n", "\"", "a;b", "#", "!", "\xc3\xa4"}) {
    const std::string shown =
        test::run_program({"sh", "-c", fmt::format("printf %s {}", shell_word(word))}, folder.path()).out;
    EXPECT_EQ(shown, word);
  }
  EXPECT_EQ(shell_word("/plain/path-1.2"), "/plain/path-1.2");
}

TEST(SlurmSbatchWords, AreOptionsThatPalpateDoesNotSayItself) {
  check_sbatch_words({"--mem=4G", "-Cfast", "--constraint=intel", "--nice", "--timeout=3", "--partitions=x"});
  for (const char* word : {"--array=0-3", "-a0-3", "--partition=x", "-px", "--time", "-t1", "--wait", "-W", "-c4",
                           "--cpus-per-task=4", "--output=x", "--wrap=ls", "script.sh", "", "-", "--", "mem=4G"}) {
    EXPECT_THROW(check_sbatch_words({"--mem=4G", word}), Error) << word;
  }
  EXPECT_EQ(test::error_of([] { check_sbatch_words({"--time=5"}); }),
            "command line: --sbatch: --time cannot be set with --sbatch, use palpate's own option --task-time");
}

/// Runs the script as Slurm does and returns the words that its program received.
class Script : public ::testing::Test {
 protected:
  test::Ended run(const std::vector<std::string>& words, const LaunchOptions& options = {}) {
    const fs::path jobs = folder_.write("it's a list/jobs", "0-3\n4-7\n8-9\n");
    const fs::path script = folder_.write("task.sh", task_script(program_, directory_, jobs, options));
    std::vector<std::string> all{"env", "PALPATE_PLUGIN_PATH=/elsewhere", words.front(), "sh", script.string()};
    all.insert(all.end(), words.begin() + 1, words.end());
    return test::run_program(all, folder_.path());
  }

  test::TemporaryFolder folder_;
  const fs::path directory_ = R"(/runs/it's "my"  $HOME; `a` & \n)";
  const fs::path program_ = make_program();

 private:
  /// Returns a program that prints the relevant part of its environment and its words, one per line.
  fs::path make_program() {
    const fs::path file =
        folder_.write("bin of 'me'/palpate",
                      "#!/bin/sh\nfor word in \"${PALPATE_PLUGIN_PATH-unset}\" "
                      "\"${PALPATE_INSTRUCTIONS-unset}\" \"$@\"; do printf '%s\\n' \"$word\"; done\n");
    fs::permissions(file, fs::perms::owner_all);
    return file;
  }
};

TEST_F(Script, CarriesOnTheJobsOfItsLineWithThePluginsOfWhoeverWroteIt) {
  EXPECT_THAT(lines_of(run({"SLURM_ARRAY_TASK_ID=0"}).out),
              ElementsAre("unset", "unset", "resume", directory_.string(), "--jobs", "0-3", "-j", "1", "--attempts",
                          "3", "--quiet"));
  const test::EnvironmentVariable plugins("PALPATE_PLUGIN_PATH", "/a b:/it's");
  const test::EnvironmentVariable instructions("PALPATE_INSTRUCTIONS", "baseline");
  LaunchOptions options;
  options.workers = 2;
  options.most_attempts = 5;
  options.resume = {true, true};
  EXPECT_THAT(lines_of(run({"SLURM_ARRAY_TASK_ID=1", "1"}, options).out),
              ElementsAre("/a b:/it's", "baseline", "resume", directory_.string(), "--jobs", "8-9", "-j", "2",
                          "--attempts", "5", "--quiet", "--retry-failed", "--force"));
}

TEST_F(Script, RunsNothingWithoutALineOfItsOwn) {
  const test::Ended ended = run({"SLURM_ARRAY_TASK_ID=3"});
  EXPECT_NE(ended.status, 0);
  EXPECT_EQ(ended.out, "");
  EXPECT_THAT(ended.err, HasSubstr("there is no such task"));
}

/// Fake commands of Slurm. They record their calls and give the answers of the test.
class FakeSlurm : public ::testing::Test {
 protected:
  FakeSlurm() {
    answer("scontrol", "echo 'MaxArraySize = 2'");
    answer("sbatch", "echo $(($(wc -l <calls.sbatch) * 100))");
    answer("squeue", "cat queue 2>/dev/null");
    answer("scancel", ":");
    for (int index = 0; index < 25; ++index) sweep_.jobs.push_back({index, fmt::format("job{}", index), {}});
    const char* path = std::getenv("PATH");
    path_ = path != nullptr ? path : "";
    ::setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
  }
  ~FakeSlurm() override { ::setenv("PATH", path_.c_str(), 1); }

  void answer(const std::string& name, const std::string& commands) const {
    const fs::path file = folder_.write(
        name, fmt::format("#!/bin/sh\ncd {}\n[ \"$1\" = --test-only ] && exit\necho \"$*\" >>calls.{}\n{}\n",
                          shell_word(folder_.path().string()), name, commands));
    fs::permissions(file, fs::perms::owner_all);
  }
  std::vector<std::string> calls(const std::string& name) const {
    return lines_of(test::text_of(folder_.path() / ("calls." + name)));
  }
  std::unique_ptr<Launcher> launcher(const LaunchOptions& options = {}) {
    return slurm_launcher.make(
        {environment_, sweep_, options, [this](const TaskArray& array) { heard_.push_back(array); }});
  }
  /// Polls until jobs return.
  static std::vector<std::size_t> returned(Launcher& launcher) {
    for (;;) {
      const Launcher::PollResult state = launcher.poll(0.1);
      if (!state.returned.empty() || state.empty_handed()) return state.returned;
    }
  }

  test::TemporaryFolder folder_;
  Sweep sweep_{folder_.path() / "runs/name/id", {}, {}};
  const Installation installation_;
  const PluginHost host_{{}};
  const RunEnvironment environment_{host_, installation_, {}, nullptr};
  std::vector<TaskArray> heard_;

 private:
  std::string path_;
};

TEST_F(FakeSlurm, HearsOptionsOnlyIfTheyAreGivenAndUsersWordsBeforeThem) {
  launcher()->submit({3});
  LaunchOptions options;
  options.workers = 2;
  options.cluster.words = {"--mem=4G", "--nice"};
  launcher(options)->submit({3, 4, 12});
  const auto words = [&](int submission, const char* user, const char* array, int cores, int first) {
    const std::string folder = (sweep_.directory / "slurm" / std::to_string(submission)).string();
    return fmt::format("--parsable {}--array={} --job-name=name --output={}/%A_%a.log --cpus-per-task={} {}/task.sh {}",
                       user, array, folder, cores, folder, first);
  };
  EXPECT_THAT(calls("sbatch"), ElementsAre(words(1, "", "0-0", 1, 0), words(2, "--mem=4G --nice ", "0-1", 2, 0),
                                           words(2, "--mem=4G --nice ", "0-0", 2, 2)));
  EXPECT_EQ(test::text_of(sweep_.directory / "slurm/2/jobs"), "3-3\n4-4\n12-12\n");
}

TEST_F(FakeSlurm, GivesEveryJobToOneTaskWithinTheLimits) {
  LaunchOptions options;
  options.jobs_per_task = 3;
  for (const int limit : {2, 3, 100}) {
    answer("scontrol", fmt::format("echo 'MaxArraySize = {}'", limit));
    heard_.clear();
    const auto one = launcher(options);
    one->submit({0, 1, 2, 3, 5, 6, 7, 8, 9, 20, 21, 22, 24});
    ASSERT_EQ(heard_.size(), static_cast<std::size_t>((5 + limit - 1) / limit)) << "no more arrays than it needs";
    EXPECT_EQ(test::text_of(heard_.front().logs / "jobs"), "0-2\n3-6\n7-9\n20-22\n24-24\n");
    int tasks = 0;
    int jobs = 0;
    for (const TaskArray& array : heard_) {
      EXPECT_THAT(calls("sbatch")[static_cast<std::size_t>(array.id / 100) - 1],
                  AllOf(HasSubstr(fmt::format("--array=0-{} ", array.tasks - 1)),
                        ::testing::EndsWith(fmt::format("task.sh {}", tasks))));
      EXPECT_LE(array.tasks, limit);
      tasks += array.tasks;
      jobs += array.jobs;
    }
    EXPECT_EQ(tasks, 5);
    EXPECT_EQ(jobs, 13);
  }
}

TEST_F(FakeSlurm, SeesNoSettingsOfTheUsersThatWouldChangeWhatItPrints) {
  const std::vector<const char*> names{"SQUEUE_FORMAT", "SBATCH_WAIT", "SBATCH_WAIT_ALL_NODES"};
  for (const char* name : names) ::setenv(name, "x", 1);
  answer("sbatch", "env >seen; echo 1");
  launcher()->submit({3});
  for (const char* name : names) ::unsetenv(name);
  const std::string seen = test::text_of(folder_.path() / "seen");
  EXPECT_THAT(seen, ::testing::Not(::testing::ContainsRegex("SQUEUE_FORMAT|SBATCH_WAIT=")));
  EXPECT_THAT(seen, HasSubstr("SBATCH_WAIT_ALL_NODES=x\n"));
}

TEST_F(FakeSlurm, LetsTasksRunOneAtATimeThoughTheArrayIsSplit) {
  LaunchOptions options;
  options.one_at_a_time = true;
  launcher(options)->submit({8, 9, 10, 11, 24});
  EXPECT_THAT(calls("sbatch"),
              ElementsAre(AllOf(HasSubstr("--array=0-1%1 "), ::testing::Not(HasSubstr("--dependency"))),
                          AllOf(HasSubstr("--array=0-1%1 "), HasSubstr("--dependency=afterany:100 ")),
                          AllOf(HasSubstr("--array=0-0%1 "), HasSubstr("--dependency=afterany:200 "))));
}

TEST_F(FakeSlurm, TellsOfArraysThatWereTakenBeforeOneIsRefused) {
  answer("sbatch", "[ $(wc -l <calls.sbatch) = 1 ] && echo 7 || { echo 'sbatch: error: too many jobs' >&2; exit 1; }");
  const auto one = launcher();
  EXPECT_THAT(test::error_of([&] { one->submit({1, 2, 11}); }), ::testing::StartsWith("sbatch: too many jobs, "));
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].id, 7);
  EXPECT_EQ(heard_[0].tasks, 2);
  EXPECT_EQ(heard_[0].jobs, 2);
}

TEST_F(FakeSlurm, AsksNothingWhenThereIsNothingToSubmit) {
  const auto one = launcher();
  one->submit({});
  one->cancel();
  EXPECT_TRUE(one->poll(10.0).empty_handed());
  for (const char* name : {"scontrol", "sbatch", "squeue", "scancel"}) EXPECT_THAT(calls(name), IsEmpty());
  EXPECT_FALSE(fs::exists(sweep_.directory / "slurm"));
}

TEST_F(FakeSlurm, CountsAndReturnsJobsByQueueAndDirectory) {
  LaunchOptions options;
  options.jobs_per_task = 4;
  options.workers = 2;
  const auto one = launcher(options);
  answer("scontrol", "echo 'MaxArraySize = 10'");
  one->submit({0, 1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(heard_[0].tasks, 3);
  EXPECT_EQ(heard_[0].jobs, 9);
  const std::string ended = "{\"manifest\": 1}\n{\"end\": \"failed\"}\n";
  folder_.write("runs/name/id/jobs/job1/record.jsonl", ended);
  folder_.write("runs/name/id/jobs/job4/record.jsonl", ended);
  folder_.write("queue", "100 R\n100 PD\n55 R\n");  // 55 belongs to another user
  Launcher::PollResult state;
  while (state.returned.empty()) state = one->poll(0.1);
  EXPECT_THAT(state.returned, ElementsAre(1, 4));
  EXPECT_EQ(state.running, 2);
  EXPECT_EQ(state.waiting, 5);
  folder_.write("queue", "55 R\n");
  EXPECT_THAT(returned(*one), ElementsAre(0, 2, 3, 5, 6, 7, 8));
  EXPECT_TRUE(one->poll(0.1).empty_handed());
}

TEST_F(FakeSlurm, ASilentQueueReturnsNothing) {
  const auto one = launcher();
  one->submit({0, 1});
  answer("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller'; exit 1");
  while (calls("squeue").size() < 2) {
    const Launcher::PollResult state = one->poll(0.1);
    EXPECT_THAT(state.returned, IsEmpty());
    EXPECT_EQ(state.running + state.waiting, 2);
  }
  answer("squeue", ":");
  EXPECT_THAT(returned(*one), ElementsAre(0, 1));
}

TEST_F(FakeSlurm, CancelsTheArraysThatHaveTasksLeft) {
  const auto one = launcher();
  one->submit({0, 1, 2, 3, 4});
  folder_.write("queue", "100 R\n300 PD\n");
  while (one->poll(0.1).running != 1) {
  }
  one->cancel();
  EXPECT_THAT(calls("scancel"), ElementsAre("100 300"));
}

TEST_F(FakeSlurm, ThatSaysNothingUsefulIsRefused) {
  const auto refusal = [&] { return test::error_of([&] { launcher()->submit({0}); }); };
  answer("sbatch", "echo hello");
  EXPECT_THAT(refusal(), HasSubstr("sbatch: hello"));
  answer("scontrol", "echo hello");
  EXPECT_THAT(refusal(), HasSubstr("scontrol: does not print MaxArraySize"));
  answer("scontrol", "kill -9 $$");
  EXPECT_THAT(refusal(), HasSubstr("scontrol: failed without a message"));
  EXPECT_THAT(heard_, IsEmpty());
}

}  // namespace
}  // namespace palpate
