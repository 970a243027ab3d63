// SPDX-License-Identifier: MIT
// `palpate report` as a user calls it; what a browser makes of its pages is looked at in tests/report.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace palpate {
namespace {

using nlohmann::json;

class Report : public Shell {
 protected:
  /// The data of the page of a run or a sweep, unpacked by other hands.
  json reported(const fs::path& directory) const {
    const Ended ended = palpate({"report", directory});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.out, (directory / "report.html").string() + "\n");
    const Ended unpacked = test::run_program(
        {"python3", "-c",
         "import base64, re, sys, zlib\n"
         "packed = re.search(r'id=\"data\">([^<]*)<', open(sys.argv[1], encoding='utf-8').read()).group(1)\n"
         "sys.stdout.write(zlib.decompress(base64.b64decode(packed)).decode())",
         (directory / "report.html").string()},
        here());
    EXPECT_EQ(unpacked.status, 0) << unpacked.err;
    return json::parse(unpacked.out);
  }
};

TEST_F(Report, OfARunThatIsUnderWayShowsWhatThereIsAndChangesNothingElse) {
  const fs::path directory = ran();
  fs::remove(directory / "summary.json");
  std::string record = text_of(directory / "record.jsonl");
  record.resize(record.find("{\"tap\": 6") + 20);  // that line is being written
  write(directory / "record.jsonl", record);
  const json data = reported(directory);
  EXPECT_EQ(data.at("taps").size(), 5U);
  EXPECT_EQ(data.at("moments").size(), 6U);
  EXPECT_TRUE(data.at("summary").is_null());
  EXPECT_EQ(data.at("state"), "unfinished");
  EXPECT_THAT(data.at("warnings").at(0).get<std::string>(),
              HasSubstr("has not ended: this page shows its state after 5"));
  EXPECT_TRUE(text_of(directory / "record.jsonl") == record);
}

TEST_F(Report, SaysThatAProgramChoosesTheNextTapAndOfAPluginWhereThatIs) {
  const std::string echo = (test::source_folder() / "plugins/acquisitions/program/echo.sh").string();
  for (const bool asks : {true, false}) {
    const fs::path directory = ran(
        Words{asks ? "acquisition={type: program, command: sh " + echo + "}" : "acquisition=uncertainty", "taps=6"});
    const json last = reported(directory).at("moments").back();
    EXPECT_EQ(last.contains("next"), !asks);
    EXPECT_EQ(last.at("is_next_known"), !asks);
    ASSERT_EQ(palpate({"report", directory, "--figures"}).status, 0);
    const std::string maps = text_of(directory / "figures/maps.gnuplot");
    EXPECT_EQ(maps.find("next tap") != std::string::npos, !asks);
  }
}

TEST_F(Report, OfWhatIsNoRunOrHasNoTapIsRefusedInOneLine) {
  fs::create_directory(here() / "empty");
  for (const char* place : {"nowhere", "empty"}) EXPECT_THAT(refused({"report", place}), HasSubstr(place));
  EXPECT_FALSE(fs::exists(here() / "nowhere"));
}

TEST_F(Report, OfSeveralRunsLiesInTheFolderThatHasThemAllOrWhereItIsWanted) {
  const fs::path one = ran("taps=4 name=one");
  const fs::path two = ran("taps=5 name=two");
  const std::string name = "side_by_side_" + one.filename().string() + "_" + two.filename().string() + ".html";
  const Ended beside = palpate({"report", one, two});
  EXPECT_EQ(beside.status, 0) << beside.err;
  EXPECT_EQ(beside.out, "runs/" + name + "\n");
  EXPECT_TRUE(fs::exists(here() / "runs" / name));
  EXPECT_FALSE(fs::exists(one / "report.html"));
  EXPECT_EQ(palpate({"report", one, two, "--to", "pages/mine"}).out, "pages/mine/" + name + "\n");
}

TEST_F(Report, IsWrittenElsewhereWhereTheRecordMayNotBeTouched) {
  const fs::path directory = ran("taps=4");
  const auto listing = [&] {
    std::vector<std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(directory)) out.push_back(entry.path().string());
    std::sort(out.begin(), out.end());
    return out;
  };
  const std::vector<std::string> before = listing();
  const Ended ended = palpate({"report", directory, "--to", "elsewhere"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, "elsewhere/report.html\n");
  EXPECT_EQ(listing(), before);
}

TEST_F(Report, OfSeveralRefusesWhatCannotStandSideBySide) {
  const fs::path run = ran("taps=4");
  const fs::path sweep = swept("taps=4 seed=1,2");
  EXPECT_THAT(refused({"report", run, sweep}), HasSubstr("is a sweep, but a page of several runs needs single runs"));
  EXPECT_THAT(refused({"report", run, run, "--figures"}), HasSubstr("--figures and --paper draw one run or sweep"));
  const std::vector<std::string> nine{"report", run, run, run, run, run, run, run, run, run};
  EXPECT_THAT(refused(nine), HasSubstr("9 runs are too many for one page"));
}

}  // namespace
}  // namespace palpate
