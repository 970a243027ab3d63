// SPDX-License-Identifier: MIT
// Records outlive the versions of a plugin whose options have changed since: tests/versions.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/algorithm/string/replace.hpp>

namespace palpate {
namespace {

class Versions : public Shell {
 protected:
  Ended with_version(int version, const Words& words) {
    const fs::path folder = test::bad_plugin_folder("").parent_path().parent_path() / "versions";
    environment_ = {"PALPATE_PLUGIN_PATH=" + (folder / std::to_string(version)).string()};
    return palpate(words);
  }
  static Words run_words(const std::string& more = "") {
    return Words{"run", config("paper/object_i.yaml"), "kernel={type: versioned}", "taps=6"} + more;
  }
  /// The folder that a run of that version would have.
  std::string id_by(int version, const std::string& more = "") {
    const std::string plan = with_version(version, run_words(more) + "--dry-run").out;
    const std::size_t end = plan.rfind(": ");
    return plan.substr(end - 12, 12);
  }
};

TEST_F(Versions, ARecordIsReadReplayedReportedAndResumedByLaterOnes) {
  ASSERT_EQ(with_version(1, run_words("--quiet")).status, 0);
  const fs::path run = directory();
  for (const int version : {2, 3}) {
    SCOPED_TRACE(version);
    const Ended replayed = with_version(version, {"replay", run.string()});
    EXPECT_EQ(replayed.status, 0) << replayed.err;
    EXPECT_THAT(replayed.out, AllOf(StartsWith("6 taps, "), EndsWith(" numbers, all equal\n")));
    EXPECT_EQ(with_version(version, {"report", run.string()}).status, 0);
    EXPECT_EQ(with_version(version, {"explain", run.string(), "4"}).status, 0);
    EXPECT_THAT(with_version(version, {"status", run.string()}).out, HasSubstr("done"));
  }
  cut_taps(run);
  fs::remove(run / "summary.json");
  const Ended resumed = with_version(3, {"resume", run.string(), "--force", "--quiet"});
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(csv_rows(text_of(run / "taps.csv")).size(), 6U);
}

TEST_F(Versions, AnIdStaysWhereTheOptionsMeanWhatTheyDid) {
  const std::string id = id_by(1);
  EXPECT_EQ(id_by(2), id) << "an option was added, with a neutral value";
  EXPECT_NE(id_by(3), id) << "two defaults are others";
  EXPECT_EQ(id_by(3, "kernel.reach=17mm kernel.power=2"), id) << "an option has gone, one has another name";
  EXPECT_NE(id_by(2, "kernel.power=1"), id);
  EXPECT_EQ(id_by(2, "kernel.verbose=true"), id) << "it changes no result";
  EXPECT_EQ(id_by(3, "kernel.scaling=2 kernel.reach=17mm kernel.power=2"), id_by(1, "kernel.stretch=2"));
}

TEST_F(Versions, WhatNoLongerExistsIsRefusedUnlessARecordHasItsLastDefault) {
  EXPECT_THAT(with_version(3, run_words("kernel.tolerance=1e-8")).err,
              HasSubstr("option 'tolerance' no longer exists, nothing has taken its place"));
  ASSERT_EQ(with_version(1, run_words("kernel.tolerance=1e-7 --quiet")).status, 0);
  EXPECT_THAT(with_version(3, {"replay", directory().string()}).err,
              HasSubstr("option 'tolerance' no longer exists, only records with the value 1e-08 can be read"));
}

TEST_F(Versions, AConfigThatWasEditedIsFoundWhateverItsFolderIsCalled) {
  const Words words = Words{"run", config("paper/object_i.yaml")} + "taps=4 --quiet";
  ASSERT_EQ(palpate(words).status, 0);
  const fs::path run = directory();
  fs::rename(run, here() / "mine");
  EXPECT_EQ(palpate("replay mine").status, 0);
  const std::string text = text_of(here() / "mine" / "config.yaml");
  write("mine/config.yaml", boost::replace_first_copy(text, "seed: 1", "seed: 2"));
  EXPECT_THAT(palpate("replay mine").err,
              AllOf(HasSubstr("mine/config.yaml: the config now has the id "),
                    HasSubstr(", the run has " + run.filename().string() + ", config.yaml was changed")));
  // Of two configs whose ids are equal by chance all digits are not.
  write("mine/config.yaml", text);
  std::string record = text_of(here() / "mine" / "record.jsonl");
  char& last = record.at(record.find("\"identity\": \"") + 13 + 31);
  last = last == '0' ? '1' : '0';
  write("mine/record.jsonl", record);
  EXPECT_THAT(palpate("replay mine").err, HasSubstr("config.yaml was changed"));
  fs::rename(here() / "mine", run);
  EXPECT_THAT(palpate(words).err,
              HasSubstr("the folder contains another run with the id " + run.filename().string() + ", give this run"));
  // On a disk that tells no capital letters two names are one folder.
  boost::replace_first(record, "\"name\": \"object", "\"name\": \"Object");
  write(run / "record.jsonl", record);
  EXPECT_THAT(palpate(words).err, HasSubstr(": the folder contains a run with the name 'Object"));
}

}  // namespace
}  // namespace palpate
