// SPDX-License-Identifier: MIT
// `palpate report` as a user calls it; what a browser makes of its pages is looked at in tests/report.
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using nlohmann::json;

/// The data of a page, unpacked by other hands.
json data_of(const fs::path& page, const TemporaryFolder& folder) {
  const Ended ended = test::run_program(
      {"python3", "-c",
       "import base64, gzip, re, sys\n"
       "packed = re.search(r'id=\"data\">([^<]*)<', open(sys.argv[1], encoding='utf-8').read()).group(1)\n"
       "sys.stdout.write(gzip.decompress(base64.b64decode(packed)).decode())",
       page.string()},
      folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  return json::parse(ended.out);
}

TEST(Report, OfASweepHoldsEveryJobItsStateAndItsNumbers) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      test::palpate({"sweep", paper(), "acquisition=weighted,uncertainty", "seed=range(0,3)", "taps=6", "--quiet"},
                    folder.path())
          .status,
      0);
  const fs::path directory = only_run(folder.path() / "runs");
  const auto results = test::csv_rows(text_of(directory / "results.csv"));
  fs::remove(directory / "jobs" / results.at(4).at("id") / "summary.json");  // as if killed before its end
  const Ended ended = test::palpate({"report", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, (directory / "report.html").string() + "\n");
  const json data = data_of(directory / "report.html", folder);
  EXPECT_EQ(data.at("name"), "object_i");
  EXPECT_EQ(data.at("id"), directory.filename().string());
  ASSERT_EQ(data.at("jobs").size(), 6U);
  for (std::size_t job = 0; job < 6; ++job) {
    EXPECT_EQ(data.at("jobs").at(job).at(0), results.at(job).at("id"));
    EXPECT_EQ(data.at("jobs").at(job).at(1), job == 4 ? "unfinished" : "done");
  }
  int compared = 0;
  for (const json& column : data.at("columns")) {
    if (column.at("name") != "rmse_m") continue;
    for (std::size_t job = 0; job < 6; ++job, ++compared) {
      const json& number = column.at("numbers").at(job);
      if (job == 4) {
        EXPECT_TRUE(number.is_null());
      } else {
        EXPECT_EQ(number.get<double>(), std::stod(results.at(job).at("rmse_m")));
      }
    }
  }
  EXPECT_EQ(compared, 6);
}

TEST(Report, OfARunThatIsUnderWayShowsWhatThereIsAndChangesNothingElse) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  fs::remove(directory / "summary.json");
  std::string taps = text_of(directory / "taps.jsonl");
  taps.resize(taps.find("{\"tap\": 6") + 20);  // the sixth line is being written
  folder.write(fs::relative(directory / "taps.jsonl", folder.path()).string(), taps);
  const Ended ended = test::palpate({"report", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  const json data = data_of(directory / "report.html", folder);
  EXPECT_EQ(data.at("taps").size(), 5U);
  EXPECT_EQ(data.at("moments").size(), 6U);
  EXPECT_TRUE(data.at("summary").is_null());
  EXPECT_EQ(data.at("run").at("state"), "unfinished");
  EXPECT_THAT(data.at("warnings").at(0).get<std::string>(), HasSubstr("has not ended: this is how it stands after 5"));
  EXPECT_TRUE(text_of(directory / "taps.jsonl") == taps);
}

TEST(Report, OfAFootprintNamesItAndShowsWhatItTells) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      test::palpate({"run", test::config("default.yaml"), "footprint.contradictions=0.01", "log.maps=true", "--quiet"},
                    folder.path())
          .status,
      0);
  const fs::path directory = only_run(folder.path() / "runs");
  ASSERT_EQ(test::palpate({"report", directory.string()}, folder.path()).status, 0);
  const json data = data_of(directory / "report.html", folder);
  EXPECT_EQ(data.at("run").at("footprint"), "shape");
  std::vector<std::string> names;
  for (const json& map : data.at("maps")) names.push_back(map.at("name"));
  EXPECT_THAT(names, ::testing::ElementsAre("height", "deviation", "u", "p", "score", "truth"));
  const json summary = json::parse(text_of(directory / "summary.json"));
  EXPECT_EQ(data.at("moments").back().at("footprint"), summary.at("footprint"));
  EXPECT_TRUE(data.at("moments").back().at("least_weight").is_null());
  const std::string remark = summary.at("footprint").at("remark");
  EXPECT_THAT(data.at("warnings").dump(), HasSubstr("The footprint, shape, says: " + remark + "."));
  const auto maps = test::csv_rows(text_of(directory / "maps/tap_030.csv"));
  EXPECT_EQ(maps.at(0).count("p"), 1U) << "the maps that log.maps keeps have it, too";
  EXPECT_EQ(maps.at(0).count("w"), 0U);
}

TEST(Report, OfASweepNamedOnTheCommandLineHasThatName) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      test::palpate({"sweep", paper(), "name=other", "seed=range(0,2)", "taps=4", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  ASSERT_EQ(test::palpate({"report", directory.string()}, folder.path()).status, 0);
  EXPECT_EQ(data_of(directory / "report.html", folder).at("name"), "other");
}

TEST(Report, OfASweepWhoseListOfJobsIsCutOffIsRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"sweep", paper(), "seed=range(0,3)", "taps=4", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  fs::resize_file(directory / "manifest.jsonl", fs::file_size(directory / "manifest.jsonl") - 20);
  for (const char* command : {"report", "status"}) {
    const Ended ended = test::palpate({command, directory.string() + "/"}, folder.path());
    EXPECT_EQ(ended.status, 2) << command;
    EXPECT_THAT(ended.err, HasSubstr("manifest.jsonl: ends in the middle of a line, the file is damaged"));
  }
}

TEST(Report, OfARunThatFailedWithoutAReasonSaysSo) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "taps=4", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  std::string summary = text_of(directory / "summary.json");
  const auto replace = [&](const std::string& from, const std::string& to) {
    summary.replace(summary.find(from), from.size(), to);
  };
  replace("\"done\"", "\"failed\"");
  replace("\"tap budget\"", "null");
  folder.write(fs::relative(directory / "summary.json", folder.path()).string(), summary);
  const Ended ended = test::palpate({"report", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(data_of(directory / "report.html", folder).at("warnings").at(0), "The run failed and does not say why.");
}

TEST(Report, OfWhatIsNoRunOrHasNoTapIsRefusedInOneLine) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "empty");
  for (const std::string& words : {std::string("nowhere"), std::string("empty")}) {
    const Ended ended = test::palpate({"report", words}, folder.path());
    EXPECT_NE(ended.status, 0);
    EXPECT_EQ(test::lines(ended.err), 1) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(ended.out, "");
  }
  EXPECT_FALSE(fs::exists(folder.path() / "nowhere"));
}

}  // namespace
}  // namespace palpate
