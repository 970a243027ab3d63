// SPDX-License-Identifier: MIT
// Every command but `run` as a user calls it: what it prints, where, and with which exit status.
#include "record/json.hpp"
#include "system/shell.hpp"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include <unistd.h>

namespace palpate {
namespace {

using Groups = Shell;
using Commands = Shell;
using Resume = Shell;
using Status = Shell;
using Validate = Shell;
using Plugins = Shell;
using CommandLine = Shell;

TEST_F(Groups, InAWorkingFolderThatOthersMayWriteAreNotTaken) {
  write("configs/backend/mine.yaml", "backend: {type: simulator}\n");
  write("mine/x.yaml", "strategy: default\nscene: object_i\nbackend: mine\n");
  EXPECT_EQ(palpate("validate mine/x.yaml").status, 0);
  for (const fs::path& open : {here(), here() / "configs"}) {
    fs::permissions(open, fs::perms::others_write, fs::perm_options::add);
    EXPECT_THAT(refused("validate mine/x.yaml"),
                HasSubstr("configs/backend/mine.yaml is in a folder where other users can write"));
    fs::permissions(open, fs::perms::others_write, fs::perm_options::remove);
  }
}

TEST_F(Commands, ThatDoNotTapEndAtOnceAtTheFirstSignal) {
  const fs::path run = ran("taps=300", (palpate::test::source_folder() / "configs/default.yaml").string());
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto child = begin({"replay", run.string()});  // which takes seconds
    ::usleep(100000);
    child->signal(signal);
    EXPECT_EQ(child->wait(600).status, 128 + signal);
  }
}

TEST_F(Resume, OfAFinishedRunRepeatsNothing) {
  const fs::path directory = ran();
  const std::string before = part_of(directory, "tap");
  const Ended ended = palpate({"resume", directory});
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, StartsWith("already done"));
  EXPECT_EQ(part_of(directory, "tap"), before);
}

TEST_F(Resume, RefusesAChangedConfigAndAnotherBuild) {
  const fs::path directory = ran();
  test::forget_end(directory);
  replace(directory / "config.yaml", "taps: 17", "taps: 18");
  EXPECT_THAT(refused({"resume", directory}), HasSubstr("config.yaml was changed"));

  replace(directory / "config.yaml", "taps: 18", "taps: 17");
  make_of_another_build(directory);
  EXPECT_THAT(refused({"resume", directory}), HasSubstr("another build"));
  EXPECT_EQ(resume(directory, "--force").status, 0);
  EXPECT_THAT(part_of(directory, "attempt"), HasSubstr("\"after_tap\": 17"));
  EXPECT_THAT(part_of(directory, "attempt"), HasSubstr("\"forced\": true"));
}

TEST_F(Resume, OfWhatIsNoRunSaysSo) {
  for (const char* command : {"resume", "status", "replay"})
    EXPECT_THAT(refused({command, here()}), HasSubstr("is not a run directory"));
}

TEST_F(Status, TellsWhereARunStandsAndWhyItStopped) {
  EXPECT_THAT(status_of(ran()).out, MatchesRegex("object_i: done after 17 of 17 taps: tap budget\n"
                                                 "expected error: [0-9]+\\.[0-9] mm over the scene\n"));
}

TEST_F(Validate, ChecksEveryShippedConfigAndNamesEveryBadOne) {
  Words words{"validate"};
  for (const auto& entry : fs::recursive_directory_iterator(config("paper"))) words.push_back(entry.path());
  const Ended good = palpate(words);
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_EQ(lines(good.out), static_cast<int>(words.size()) - 1);
  EXPECT_THAT(good.out, HasSubstr("a sweep of 4000 jobs"));

  write("bad.yaml", "taps: many\n");
  const Ended mixed = palpate({"validate", "bad.yaml", paper(), "missing.yaml"});
  EXPECT_EQ(mixed.status, 2);
  EXPECT_EQ(lines(mixed.err), 2);
  EXPECT_EQ(lines(mixed.out), 1);
  EXPECT_TRUE(left_nothing());
}

TEST_F(Plugins, ListsEveryOneAndTheOptionsOfOne) {
  const Ended all = palpate("plugins");
  EXPECT_EQ(all.status, 0) << all.err;
  for (const char* name : {"rbf", "matern12", "matern32", "matern52", "rational_quadratic", "sum", "product", "scale",
                           "uncertainty", "weighted", "random", "grid", "fixed", "simulator", "replay"}) {
    EXPECT_THAT(all.out, HasSubstr(name));
  }
  EXPECT_EQ(lines(palpate("plugins kernel").out), 8);
  EXPECT_THAT(palpate("plugins kernel/sum").out,
              ContainsRegex("kernels +list of plugins of kind kernel +required +list of the kernels to combine"));
  EXPECT_THAT(palpate("plugins kernel/rbf").out,
              AllOf(HasSubstr("length_scale"), HasSubstr("> 0 m"), HasSubstr("0.017 m")));
  EXPECT_THAT(palpate("plugins backend/simulator").out, HasSubstr("written beside backend, not inside it"));
  EXPECT_TRUE(nlohmann::json::accept(palpate("plugins --json").out));
  EXPECT_EQ(refused("plugins kernel/rfb"), "no plugin kernel/rfb, did you mean 'rbf'?\n");
}

TEST_F(CommandLine, HelpSaysWhatItTakesWithNamesThatEveryVersionOfItsLibraryAccepts) {
  // CLI11 2.4 refuses names of positional arguments with '=' or '/' in them before it has read any.
  EXPECT_THAT(palpate("run --help").out, AllOf(ContainsRegex("Usage: palpate run .* CONFIG \\[OVERRIDE\\.\\.\\.\\]\n"),
                                               ContainsRegex("\n +OVERRIDE KEY=VALUE \\.\\.\\. +value that replaces")));
  EXPECT_THAT(palpate("sweep --help").out,
              ContainsRegex("\n +AXIS KEY=VALUES \\.\\.\\. +key and the values that the sweep uses"));
  EXPECT_THAT(palpate("plugins --help").out, ContainsRegex("\n +PLUGIN KIND\\[/NAME\\] +plugin kind"));
}

TEST_F(CommandLine, WrongUsageIsOneLineWithStatus2) {
  for (const char* words : {"rum", "run", "sweep", "plugins kernels"}) refused(words);
  for (const char* words : {"--jsno", "--origins"}) refused(Words{"run", paper()} + words);
  refused({"sweep", paper(), "-j", "0"});
}

TEST_F(CommandLine, ACommandThatThereIsNotIsToldTheNearest) {
  EXPECT_EQ(refused({"runn", paper()}), "no command 'runn', did you mean 'run'?\n");
  EXPECT_THAT(refused("frobnicate"), StartsWith("no command 'frobnicate', known: run, sweep, tune, resume, "));
}

TEST_F(CommandLine, SeveralDirectoriesWhereACommandTakesOneAreOneLineWithARemedy) {
  for (const char* command : {"status", "resume", "replay", "export"}) {
    EXPECT_THAT(
        refused({command, "runs/a/1", "runs/a/2"}),
        MatchesRegex(
            std::string("command line: ") + command +
            " takes one (DIR|RUN), but 'runs/a/2' is given as well, if a \\* matches several, name one of them\n"));
  }
  EXPECT_THAT(refused("explain runs/a/1 runs/a/2 3"), HasSubstr(" takes one RUN and one TAP, but "));
  EXPECT_THAT(refused("report runs/a/1 --fig"), Not(HasSubstr("takes one DIR"))) << "an option is no directory";
}

TEST_F(CommandLine, WhatMayNotBeReadIsNotCalledMissing) {
  write("closed/one.yaml", "seed: 1\n");
  write("two.yaml", "seed: 1\n");
  fs::permissions(here(), fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
  fs::permissions(here() / "closed", fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(here() / "two.yaml", fs::perms::none);
  const auto as_anybody = [&](const Words& words) {
    // root may read everything
    const Words nobody = "/usr/bin/setpriv --reuid=65534 --regid=65534 --clear-groups";
    return test::run_program(::geteuid() == 0 ? nobody + words : words, here());
  };
  const fs::path program = test::program_file();
  if (as_anybody({"/usr/bin/test", "-r", program.parent_path() / "lib/palpate"}).status != 0) {
    GTEST_SKIP() << "only root may enter the folder of this build";
  }
  const auto refusal = [&](const std::string& file) { return as_anybody({program, "validate", file}).err; };
  EXPECT_EQ(refusal("closed/one.yaml"), "closed/one.yaml: cannot be read, check the permissions of its folder\n");
  EXPECT_EQ(refusal("two.yaml"), "two.yaml: cannot be read, check its permissions\n");
  fs::permissions(here() / "closed", fs::perms::owner_all);
}

}  // namespace
}  // namespace palpate
