// SPDX-License-Identifier: MIT
// Every command but `run` as a user calls it: what it prints, where, and with which exit status.
#include "record/json.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {
namespace {

TEST(Groups, InAWorkingFolderThatOthersMayWriteAreNotTaken) {
  const TemporaryFolder folder;
  folder.write("configs/backend/mine.yaml", "backend: {type: simulator}\n");
  folder.write("mine/x.yaml", "strategy: default\nscene: object_i\nbackend: mine\n");
  const std::vector<std::string> words{"validate", "mine/x.yaml"};
  EXPECT_EQ(test::palpate(words, folder.path()).status, 0);
  const auto refused_with = [&](const fs::path& open) {
    fs::permissions(open, fs::perms::others_write, fs::perm_options::add);
    const Ended ended = test::palpate(words, folder.path());
    fs::permissions(open, fs::perms::others_write, fs::perm_options::remove);
    EXPECT_EQ(ended.status, 2);
    return ended.err;
  };
  for (const fs::path& open : {folder.path(), folder.path() / "configs"}) {
    EXPECT_THAT(refused_with(open), HasSubstr("configs/backend/mine.yaml lies where others may put files"));
  }
}

TEST(Commands, ThatDoNotTapEndAtOnceAtTheFirstSignal) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.write("sweep/config.yaml", "").parent_path() / "manifest.jsonl";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    test::Child child({test::program_file().string(), "status", "sweep"}, folder.path());
    int writer = -1;  // can be opened once the program reads, which then waits for what never comes
    while (child.running() && (writer = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK)) < 0) ::usleep(1000);
    child.signal(signal);
    EXPECT_EQ(child.wait(60).status, 128 + signal);
    ::close(writer);
  }
}

TEST(Resume, OfAFinishedRunRepeatsNothing) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string before = text_of(directory / "taps.jsonl");
  const Ended ended = test::palpate({"resume", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, StartsWith("already done"));
  EXPECT_EQ(text_of(directory / "taps.jsonl"), before);
}

TEST(Resume, RefusesAChangedConfigAndAnotherBuild) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  fs::remove(directory / "summary.json");
  const std::string text = text_of(directory / "config.yaml");
  std::string changed = text;
  changed.replace(changed.find("taps: 17"), 8, "taps: 18");
  std::ofstream(directory / "config.yaml") << changed;
  const Ended config_changed = test::palpate({"resume", directory.string()}, folder.path());
  EXPECT_EQ(config_changed.status, 2);
  EXPECT_THAT(config_changed.err, HasSubstr("config.yaml was changed"));

  std::ofstream(directory / "config.yaml") << text;
  std::string manifest = text_of(directory / "manifest.json");
  const auto build = manifest.find("\"build\": \"") + 10;
  manifest[build] = manifest[build] == '0' ? '1' : '0';
  std::ofstream(directory / "manifest.json") << manifest;
  const Ended other = test::palpate({"resume", directory.string()}, folder.path());
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("another build"));
  EXPECT_EQ(test::palpate({"resume", directory.string(), "--force"}, folder.path()).status, 0);
  EXPECT_THAT(text_of(directory / "manifest.json"), HasSubstr("\"after_tap\": 17"));
}

TEST(Resume, OfWhatIsNoRunSaysSo) {
  const TemporaryFolder folder;
  for (const char* command : {"resume", "status", "replay"}) {
    const Ended ended = test::palpate({command, folder.path().string()}, folder.path());
    EXPECT_EQ(ended.status, 2) << command;
    EXPECT_THAT(ended.err, HasSubstr("is not a run directory"));
    EXPECT_EQ(lines(ended.err), 1);
  }
}

TEST(Status, TellsWhereARunStandsAndWhyItStopped) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const Ended ended = test::palpate({"status", only_run(folder.path() / "runs").string()}, folder.path());
  EXPECT_EQ(ended.out, "object_i: done after 17 of 17 taps: tap budget\n");
}

TEST(Validate, ChecksEveryShippedConfigAndNamesEveryBadOne) {
  const TemporaryFolder folder;
  std::vector<std::string> words{"validate"};
  for (const auto& entry : fs::recursive_directory_iterator(test::source_folder() / "configs" / "paper"))
    words.push_back(entry.path().string());
  const Ended good = test::palpate(words, folder.path());
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_EQ(lines(good.out), static_cast<int>(words.size()) - 1);
  EXPECT_THAT(good.out, HasSubstr("a sweep of 4000 jobs"));

  const fs::path bad = folder.write("bad.yaml", "taps: many\n");
  const Ended mixed = test::palpate({"validate", bad.string(), paper(), "missing.yaml"}, folder.path());
  EXPECT_EQ(mixed.status, 2);
  EXPECT_EQ(lines(mixed.err), 2);
  EXPECT_EQ(lines(mixed.out), 1);
  EXPECT_FALSE(fs::exists(folder.path() / "runs"));
}

TEST(Plugins, ListsEveryOneAndTheOptionsOfOne) {
  const TemporaryFolder folder;
  const Ended all = test::palpate({"plugins"}, folder.path());
  EXPECT_EQ(all.status, 0) << all.err;
  for (const char* name : {"rbf", "matern12", "matern32", "matern52", "rational_quadratic", "sum", "product", "scale",
                           "uncertainty", "weighted", "random", "grid", "fixed", "simulator", "replay"}) {
    EXPECT_THAT(all.out, HasSubstr(name));
  }
  EXPECT_EQ(lines(test::palpate({"plugins", "kernel"}, folder.path()).out), 8);
  EXPECT_THAT(test::palpate({"plugins", "kernel/sum"}, folder.path()).out,
              testing::ContainsRegex("kernels +list of plugins of kind kernel +required +the parts"));
  const Ended one = test::palpate({"plugins", "kernel/rbf"}, folder.path());
  EXPECT_THAT(one.out, HasSubstr("length_scale"));
  EXPECT_THAT(one.out, HasSubstr("> 0 m"));
  EXPECT_THAT(one.out, HasSubstr("0.017 m"));
  const Ended json = test::palpate({"plugins", "--json"}, folder.path());
  EXPECT_TRUE(is_json(json.out));
  const Ended missing = test::palpate({"plugins", "kernel/rfb"}, folder.path());
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(missing.err, "no plugin kernel/rfb, did you mean 'rbf'?\n");
}

TEST(CommandLine, HelpGoesToStdoutWithStatus0) {
  const TemporaryFolder folder;
  for (const char* command : {"", "run", "sweep", "resume", "status", "replay", "validate", "plugins", "schema"}) {
    std::vector<std::string> words{"--help"};
    if (*command != '\0') words.insert(words.begin(), command);
    const Ended help = test::palpate(words, folder.path());
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_EQ(help.err, "") << command;
    EXPECT_THAT(help.out, HasSubstr("--help")) << command;
  }
}

TEST(CommandLine, HelpSaysWhatItTakesWithNamesThatEveryVersionOfItsLibraryAccepts) {
  // CLI11 2.4 refuses names of positional arguments with '=' or '/' in them before it has read any.
  const TemporaryFolder folder;
  const auto help = [&](const char* command) { return test::palpate({command, "--help"}, folder.path()).out; };
  EXPECT_THAT(help("run"), testing::ContainsRegex("Usage: palpate run .* CONFIG \\[OVERRIDE\\.\\.\\.\\]\n"));
  EXPECT_THAT(help("run"), testing::ContainsRegex("\n +OVERRIDE KEY=VALUE \\.\\.\\. +override a value"));
  EXPECT_THAT(help("sweep"), testing::ContainsRegex("\n +AXIS KEY=VALUES \\.\\.\\. +what to vary"));
  EXPECT_THAT(help("plugins"), testing::ContainsRegex("\n +PLUGIN KIND\\[/NAME\\] +a kind"));
}

TEST(CommandLine, WrongUsageIsOneLineWithStatus2) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> wrong{{},
                                                    {"rum"},
                                                    {"run"},
                                                    {"run", paper(), "--jsno"},
                                                    {"sweep"},
                                                    {"run", paper(), "--origins"},
                                                    {"plugins", "kernels"},
                                                    {"sweep", paper(), "-j", "0"}};
  for (const auto& words : wrong) {
    const Ended ended = test::palpate(words, folder.path());
    EXPECT_EQ(ended.status, 2) << (words.empty() ? "" : words.back());
    EXPECT_EQ(lines(ended.err), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  }
}

TEST(CommandLine, ACommandThatThereIsNotIsToldTheNearest) {
  const TemporaryFolder folder;
  EXPECT_EQ(test::palpate({"runn", paper()}, folder.path()).err, "no command 'runn', did you mean 'run'?\n");
  EXPECT_THAT(test::palpate({"frobnicate"}, folder.path()).err,
              StartsWith("no command 'frobnicate', known: run, sweep, resume, "));
}

TEST(CommandLine, WhatMayNotBeReadIsNotCalledMissing) {
  const TemporaryFolder folder;
  folder.write("closed/one.yaml", "seed: 1\n");
  folder.write("two.yaml", "seed: 1\n");
  fs::permissions(folder.path(), fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
  fs::permissions(folder.path() / "closed", fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(folder.path() / "two.yaml", fs::perms::none);
  const auto as_anybody = [&](std::vector<std::string> words) {
    // root may read everything
    if (::geteuid() == 0)
      words.insert(words.begin(), {"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"});
    return test::run_program(words, folder.path());
  };
  const fs::path program = test::program_file();
  if (as_anybody({"/usr/bin/test", "-r", (program.parent_path() / "lib/palpate").string()}).status != 0) {
    GTEST_SKIP() << "only root may enter the folder of this build";
  }
  const auto refusal = [&](const std::string& file) { return as_anybody({program.string(), "validate", file}).err; };
  EXPECT_EQ(refusal("closed/one.yaml"), "closed/one.yaml: cannot be read, check the permissions of its folder\n");
  EXPECT_EQ(refusal("two.yaml"), "two.yaml: cannot be read, check its permissions\n");
  fs::permissions(folder.path() / "closed", fs::perms::owner_all);
}

}  // namespace
}  // namespace palpate
