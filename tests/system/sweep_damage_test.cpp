// SPDX-License-Identifier: MIT
// Files of a sweep that were changed or damaged: of the whole it is refused, of one job it costs that job alone.
#include "system/one_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

namespace palpate {
namespace {

class DamagedSweep : public test::OneSweep {
 protected:
  void SetUp() override { ASSERT_EQ(palpate({"sweep", paper(), "taps=4", "seed=range(0,4)", "--quiet"}).status, 0); }
  void write(const fs::path& file, const std::string& text) const {
    folder_.write(fs::relative(file, folder_.path()).string(), text);
  }
  /// Puts `text` in the place of `part`, which must be there.
  void replace(const fs::path& file, const std::string& part, const std::string& text) const {
    std::string all = text_of(file);
    const auto at = all.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    write(file, all.replace(at, part.size(), text));
  }
};

TEST_F(DamagedSweep, IsRefusedByEveryCommandWhereItsManifestWasChanged) {
  const std::string whole = text_of(directory() / "manifest.jsonl");
  const std::string results = text_of(directory() / "results.csv");
  const std::string id = job(0).filename().string();
  const std::vector<std::pair<std::string, std::string>> changes{{"\"value_0\"", "\"walue_0\""},
                                                                 {"\"value_1\": \"0\"", "\"value_1\": \"9\""},
                                                                 {"\"key_1\": \"seed\"", "\"key_1\": \"sped\""},
                                                                 {id, "../../victim"}};
  for (const auto& [part, text] : changes) {
    replace(directory() / "manifest.jsonl", part, text);
    const std::string at = directory().string();
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"status", at},
                                               {"resume", at},
                                               {"report", at},
                                               {"compare", at, "--by", "taps", "--metric", "rmse_m"},
                                               {"pareto", at, "--cost", "robot_seconds", "--error", "rmse_m"}}) {
      const Ended ended = palpate(words);
      EXPECT_EQ(ended.status, 2) << words.front() << ": " << text;
      EXPECT_EQ(lines(ended.err), 1) << ended.err;
      EXPECT_THAT(ended.err, HasSubstr(directory().string()));
    }
    write(directory() / "manifest.jsonl", whole);
  }
  EXPECT_EQ(text_of(directory() / "results.csv"), results);
  EXPECT_FALSE(fs::exists(directory().parent_path() / "victim"));
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
  const std::string sound = text_of(job(0) / GetParam().file);
  for (int i : {0, 2}) {
    fs::remove(job(i) / "summary.json");
    fs::resize_file(job(i) / "taps.jsonl", fs::file_size(job(i) / "taps.jsonl") / 2);
  }
  const std::string half = text_of(job(0) / "taps.jsonl");
  write(job(0) / GetParam().file, GetParam().text);
  const Ended ended = resume();
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, AllOf(HasSubstr("failed: job 0 (" + job(0).filename().string() + ")"),
                               HasSubstr((job(0) / GetParam().file).string()), Not(HasSubstr("failed: job 1")),
                               Not(HasSubstr("failed: job 2")), Not(HasSubstr("failed: job 3"))));
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(status(), AllOf(StartsWith("4 jobs, 3 done, 0 running, 1 failed"), HasSubstr(GetParam().file)));
  EXPECT_EQ(lines(text_of(directory() / "results.csv")), 5);
  EXPECT_EQ(text_of(job(2) / "taps.csv"), taps[2]);
  EXPECT_EQ(text_of(job(0) / GetParam().file), GetParam().text) << "nothing of it is overwritten";
  for (const char* command : {"report", "status"}) EXPECT_EQ(palpate({command, directory().string()}).status, 0);

  const std::string file = GetParam().file;
  if (file == "summary.json") {
    fs::remove(job(0) / file);
  } else {
    write(job(0) / file, file == "taps.jsonl" ? half : sound);
  }
  const Ended again = resume({"--retry-failed"});
  EXPECT_EQ(again.status, 0) << again.out << again.err;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(text_of(job(i) / "taps.csv"), taps[static_cast<std::size_t>(i)]) << i;
}

INSTANTIATE_TEST_SUITE_P(OfEachFile, DamagedJob,
                         testing::Values(Damage{"config.yaml", "{name: x},"}, Damage{"config.yaml", "taps: 5\n"},
                                         Damage{"manifest.json", "{},"}, Damage{"manifest.json", ""},
                                         Damage{"taps.jsonl", "{\"tap\": 1\n{}\n"}, Damage{"taps.jsonl", "{}\n"},
                                         Damage{"summary.json", ""}, Damage{"summary.json", "{\"status\": \"do"},
                                         Damage{"attempts.jsonl", "{\"attempt\n{}\n"}));

TEST_F(DamagedSweep, IsSummedUpWhereOnlyTheConfigOfAFinishedJobCannotBeRead) {
  const std::string whole = resume().out;
  write(job(0) / "config.yaml", "");
  const Ended ended = resume();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, whole);
}

TEST_F(DamagedSweep, CountsAsFailedWhatCouldNotEvenRecordItsFailure) {
  for (int i = 0; i < 4; ++i) {
    for (const char* name : {"summary.json", "taps.jsonl", "attempts.jsonl"}) fs::remove(job(i) / name);
  }
  // No file may grow, as on a full disk; what is said goes into a pipe.
  const std::string words = test::program_file().string() + " resume " + directory().string();
  const Ended ended = test::run_program(
      {"/bin/sh", "-c", "( trap '' XFSZ; ulimit -f 0; " + words + " || echo refused ) 2>&1 | cat"}, folder_.path());
  EXPECT_THAT(ended.out, AllOf(HasSubstr("job 3: "), HasSubstr("cannot be written: File too large"),
                               HasSubstr("0 of 4 jobs done, 0 running, 4 failed"), EndsWith("refused\n")));
  EXPECT_EQ(resume().status, 0) << "when there is room again";
  EXPECT_THAT(status(), StartsWith("4 jobs, 4 done"));
}

}  // namespace
}  // namespace palpate
