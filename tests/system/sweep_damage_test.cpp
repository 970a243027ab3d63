// SPDX-License-Identifier: MIT
// Files of a sweep that were changed or damaged: of the whole it is refused, of one job it costs that job alone.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

namespace palpate {
namespace {

class DamagedSweep : public Shell {
 protected:
  void SetUp() override { sweep_ = swept("taps=4 seed=range(0,4)"); }
  fs::path job(int index) const { return job_of(sweep_, index); }

  fs::path sweep_;
};

TEST_F(DamagedSweep, IsRefusedByEveryCommandWhereItsManifestWasChanged) {
  const fs::path manifest = sweep_ / "manifest.jsonl";
  const std::string whole = text_of(manifest);
  const std::string results = text_of(sweep_ / "results.csv");
  const std::vector<std::pair<std::string, std::string>> changes{{"\"value_0\"", "\"walue_0\""},
                                                                 {"\"value_1\": \"0\"", "\"value_1\": \"9\""},
                                                                 {"\"key_1\": \"seed\"", "\"key_1\": \"sped\""},
                                                                 {job(0).filename(), "../../victim"}};
  for (const auto& [part, text] : changes) {
    replace(manifest, part, text);
    for (const Words& words : {Words{"status", sweep_}, Words{"resume", sweep_}, Words{"report", sweep_},
                               Words{"compare", sweep_} + "--by taps --metric rmse_m",
                               Words{"pareto", sweep_} + "--cost robot_seconds --error rmse_m"}) {
      EXPECT_THAT(refused(words), HasSubstr(sweep_.string())) << text;
    }
    write(manifest, whole);
  }
  fs::resize_file(manifest, whole.size() - 20);
  for (const char* command : {"report", "status"}) {
    EXPECT_THAT(refused({command, sweep_.string() + "/"}),
                HasSubstr("manifest.jsonl: ends in the middle of a line, the file is damaged"));
  }
  EXPECT_EQ(text_of(sweep_ / "results.csv"), results);
  EXPECT_FALSE(fs::exists(sweep_.parent_path() / "victim"));
}

/// A file of one job, and what stands there instead.
struct Damage {
  const char* file;
  std::string text;
  friend std::ostream& operator<<(std::ostream& out, const Damage& one) { return out << one.file << ": " << one.text; }
};

class DamagedJob : public DamagedSweep, public testing::WithParamInterface<Damage> {};

TEST_P(DamagedJob, FailsAloneIsNamedAndIsCarriedOnOnceItWasPutRight) {
  std::vector<std::string> taps;
  for (int i = 0; i < 4; ++i) taps.push_back(text_of(job(i) / "taps.csv"));
  const fs::path file = job(0) / GetParam().file;
  std::string sound = text_of(file);
  for (int i : {0, 2}) break_off(job(i));
  if (file.filename() == "record.jsonl") sound = text_of(file);
  write(file, GetParam().text);
  const Ended ended = resume(sweep_);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("failed: job 0 (" + job(0).filename().string() + ")"), HasSubstr(file.string()),
                    Not(HasSubstr("failed: job 1")), Not(HasSubstr("failed: job 2")), Not(HasSubstr("failed: job 3"))));
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(status_of(sweep_).out,
              AllOf(StartsWith("4 jobs, 3 done, 0 running, 1 failed"), HasSubstr(GetParam().file)));
  EXPECT_EQ(lines(text_of(sweep_ / "results.csv")), 5);
  EXPECT_EQ(text_of(job(2) / "taps.csv"), taps[2]);
  EXPECT_THAT(text_of(file), StartsWith(GetParam().text)) << "nothing of it is overwritten";
  for (const char* command : {"report", "status"}) EXPECT_EQ(palpate({command, sweep_}).status, 0);

  write(file, sound);
  const Ended again = resume(sweep_, "--retry-failed");
  EXPECT_EQ(again.status, 0) << again.out << again.err;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(text_of(job(i) / "taps.csv"), taps[static_cast<std::size_t>(i)]) << i;
}

INSTANTIATE_TEST_SUITE_P(OfEachFile, DamagedJob,
                         testing::Values(Damage{"config.yaml", "{name: x},"}, Damage{"config.yaml", "taps: 5\n"},
                                         Damage{"record.jsonl", "{\"manifest\": 1},\n"},
                                         Damage{"record.jsonl", "{\"manifest\": [}\n"},
                                         Damage{"record.jsonl", "{\"manifest\": 1}\n{\"tap\": 1\n{}\n"},
                                         Damage{"record.jsonl", "{}\n"},
                                         Damage{"record.jsonl", "{\"manifest\": 1}\n{\"attempt\n{}\n"},
                                         Damage{"record.jsonl", "{\"manifest\": 1}\n{\"end\": \"do\n"}));

TEST_F(DamagedSweep, IsSummedUpWhereOnlyTheConfigOfAFinishedJobCannotBeRead) {
  const std::string whole = resume(sweep_).out;
  write(job(0) / "config.yaml", "");
  const Ended ended = resume(sweep_);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, whole);
}

TEST_F(DamagedSweep, CountsAsFailedWhatCouldNotEvenRecordItsFailure) {
  for (int i = 0; i < 4; ++i) {
    for (const char* name : {"summary.json", "record.jsonl"}) fs::remove(job(i) / name);
  }
  // No file may grow, as on a full disk; what is said goes into a pipe.
  const std::string words = test::program_file().string() + " resume " + sweep_.string();
  const Ended ended = test::run_program(
      {"/bin/sh", "-c", "( trap '' XFSZ; ulimit -f 0; " + words + " || echo refused ) 2>&1 | cat"}, here());
  EXPECT_THAT(ended.out, AllOf(HasSubstr("job 3: "), HasSubstr("cannot be written: File too large"),
                               HasSubstr("0 of 4 jobs done, 0 running, 4 failed"), EndsWith("refused\n")));
  EXPECT_EQ(resume(sweep_).status, 0) << "when there is room again";
  EXPECT_THAT(status_of(sweep_).out, StartsWith("4 jobs, 4 done"));
}

}  // namespace
}  // namespace palpate
