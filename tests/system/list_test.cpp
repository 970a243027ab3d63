// SPDX-License-Identifier: MIT
// `palpate list` as a user calls it, and names of runs as every command takes them.
#include "system/shell.hpp"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class List : public Shell {
 protected:
  Ended list(const Words& more = {}) const {
    Ended ended = palpate(Words{"list"} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
};

TEST_F(List, ShowsRunsAndSweepsInTheOrderInWhichTheyWereBegun) {
  const fs::path first = ran("taps=3");
  const fs::path many = swept("name=many taps=3 seed=1,2 acquisition=weighted,uncertainty");
  const fs::path last = ran("taps=4 name=last scene=ring");
  const Ended all = list();
  EXPECT_EQ(all.err, "");
  EXPECT_THAT(all.out,
              MatchesRegex("name +begun +strategy +scene +taps +rmse_m \\[mm\\] +IoU +state +set apart by +directory\n"
                           "object_i +[-0-9T:]+ +weighted +object_i +3 .* done +runs/object_i/[0-9a-f]+\n"
                           "many +[-0-9T:]+ +weighted, uncertainty +object_i +4 of 4 jobs done +seed \\(2\\), "
                           "acquisition \\(2\\) +runs/many/.*\n"
                           "last +[-0-9T:]+ +weighted +ring +4 .* done +runs/last/[0-9a-f]+\n"));
  EXPECT_EQ(lines(list({"runs/last"}).out), 2);
  EXPECT_THAT(list({"--where", "jobs_done == 4"}).out, AllOf(HasSubstr("many"), Not(HasSubstr("last"))));
  const std::string json = list({"--json", "--where", "taps == 4 and seed == 1"}).out;
  EXPECT_TRUE(nlohmann::json::accept(json)) << json;
  EXPECT_THAT(json, AllOf(HasSubstr("\"scene\": \"ring\""), Not(HasSubstr("object_i\""))));
}

TEST_F(List, OfWhatIsDamagedSaysSoAndShowsTheRest) {
  const fs::path whole = ran("taps=3");
  const fs::path killed = ran("taps=3 seed=2");
  break_off(killed);
  const fs::path damaged = ran("taps=3 seed=3");
  write(damaged / "record.jsonl", "{\"manifest\": 1}\n{\"end\": \n");
  write("runs/notes/text.md", "");
  const fs::path sweep = swept("name=many taps=3 seed=1,2");
  replace(sweep / "config.yaml", "taps: ", "taps: 1");
  const Ended all = list();
  EXPECT_EQ(lines(all.out), 3) << all.out;
  EXPECT_THAT(all.out, ContainsRegex("object_i .* 1 +unfinished +seed 2 +runs/object_i/"));
  EXPECT_EQ(lines(all.err), 3) << all.err;
  EXPECT_THAT(all.err, HasSubstr("record.jsonl: its last line is not a JSON object, put the file back"));
  EXPECT_THAT(all.err, HasSubstr("config.yaml or manifest.jsonl was changed after this sweep started"));
  EXPECT_THAT(all.err, HasSubstr("runs: not listed: 1 folder without a run\n"));
}

TEST_F(List, OfAFolderWithoutRunsIsOneLine) {
  EXPECT_EQ(refused("list"), "runs: is not a folder, start a run, which creates runs/, or name another folder\n");
  write("file", "");
  EXPECT_EQ(refused("list file"), "file: Not a directory, name a folder with runs\n");
  fs::create_directory(here() / "runs");
  const Ended empty = list();
  EXPECT_EQ(empty.out, "");
  EXPECT_EQ(empty.err, "runs: contains no runs and no sweeps\n");
  EXPECT_EQ(list({"--json"}).out, "[]\n");
  ran("taps=3");
  EXPECT_EQ(list({"--where", "taps > 3"}).err, "command line: --where: matches none of 1\n");
  EXPECT_THAT(refused({"list", "--where", "tapps > 3"}), HasSubstr("the unknown name 'tapps', did you mean 'taps'?"));
  const fs::path sweep = swept("name=many taps=3 seed=1,2");
  EXPECT_THAT(list({"--where", "seed == 2", "runs/many"}).err,
              AllOf(HasSubstr("matches none of 1; to filter the jobs of a sweep, use 'palpate list runs/many/"),
                    HasSubstr("/jobs --where ...'\n")));
}

TEST_F(List, NamesStandForARunOrASweepInEveryCommandThatTakesOne) {
  const fs::path run = ran({"taps=12", "name=a b"});
  const fs::path folder = run.parent_path();
  for (const char* command : {"status", "resume", "replay", "report", "export", "calibrate"}) {
    for (const std::string& words : {std::string("a b"), std::string("a b@latest"), folder.filename().string(),
                                     folder.string(), std::string("runs")}) {
      const Ended ended = palpate({command, words});
      EXPECT_NE(ended.status, 2) << command << " " << words << ": " << ended.err;
    }
  }
  EXPECT_THAT(palpate({"explain", "a b", "6"}).out, StartsWith("Tap 6 of 12, run a b"));
  EXPECT_TRUE(fs::exists(run / "report.html"));
  swept("name=many taps=3 seed=1,2 acquisition=weighted,uncertainty");
  for (const char* command : {"pareto many --cost taps --error rmse_m", "compare runs --by acquisition --metric rmse_m",
                              "resume many --quiet", "status many@latest", "report many"}) {
    EXPECT_EQ(palpate(command).status, 0) << command;
  }
}

TEST_F(List, AFolderWithARecordWinsOverANameAndOneWithoutDoesNot) {
  ran("taps=3");
  fs::create_directory(here() / "object_i");
  EXPECT_EQ(palpate("status object_i").out.substr(0, 38), "object_i: done after 3 of 3 taps: tap ") << "sources, say";
  fs::copy(ran("taps=4 name=other"), here() / "object_i/one", fs::copy_options::recursive);
  EXPECT_THAT(palpate("status object_i").out, HasSubstr("other: done after 4 of 4 taps"));
}

}  // namespace
}  // namespace palpate
