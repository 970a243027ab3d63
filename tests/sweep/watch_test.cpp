// SPDX-License-Identifier: MIT
// `palpate watch` without a browser and without another process: a growing log, a history that is read in between, and
// a server without visitors.
#include "record/json.hpp"
#include "record/run.hpp"
#include "report/history.hpp"
#include "support/parts.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"
#include "watch/growing_log.hpp"
#include "watch/server.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kBegun = test::begun_record();

class AGrowingLog : public ::testing::Test {
 protected:
  void append(const std::string& text) const {
    std::ofstream(file_, std::ios::app | std::ios::binary) << text << std::flush;
  }
  /// Returns the numbers of the new taps.
  std::vector<int> read() {
    anew_ = false;
    std::vector<int> out;
    for (const RecordLine& line : log_.read(anew_)) {
      if (line.kind == LineKind::tap) out.push_back(static_cast<int>(line.row.number("tap").value()));
    }
    return out;
  }

  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_.path() / "record.jsonl";
  GrowingLog log_{file_};
  bool anew_ = false;
};

TEST_F(AGrowingLog, HasEachTapOnceWhenItsLineIsWhole) {
  EXPECT_THAT(read(), IsEmpty()) << "before there is a file";
  append(kBegun + "{\"tap\": 1}\n{\"tap\": 2}\n{\"ta");
  EXPECT_THAT(read(), ElementsAre(1, 2));
  EXPECT_FALSE(anew_);
  append("p\": 3}");
  EXPECT_THAT(read(), IsEmpty());
  append("\n");
  EXPECT_THAT(read(), ElementsAre(3));
  EXPECT_THAT(read(), IsEmpty());
  EXPECT_FALSE(anew_);
}

TEST_F(AGrowingLog, HasEveryLineWithItsKind) {
  append(test::begun_record(true) + "{\"intent\": 1}\n");
  std::vector<LineKind> kinds;
  for (const RecordLine& line : log_.read(anew_)) kinds.push_back(line.kind);
  EXPECT_THAT(kinds, ElementsAre(LineKind::manifest, LineKind::attempt, LineKind::setup, LineKind::intent));
  append("{\"tap\": 1, \"x\": 0.1}\n{\"objects\": []}\n");
  const std::vector<RecordLine> lines = log_.read(anew_);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(to_json_line(lines[0].row), "{\"tap\": 1, \"x\": 0.1}");
  append("{\"end\": \"interrupted\"}\n");
  EXPECT_THAT(read(), IsEmpty());
  EXPECT_FALSE(anew_);
}

TEST_F(AGrowingLog, LosesNothingWhenHalfALineIsCutOffAndMadeAnew) {
  append(kBegun + "{\"tap\": 1}\n{\"tap\": 2, \"x\": 0.1");
  EXPECT_THAT(read(), ElementsAre(1));
  fs::resize_file(file_, kBegun.size() + 11);
  EXPECT_THAT(read(), IsEmpty());
  append("{\"tap\": 2}\n");
  EXPECT_THAT(read(), ElementsAre(2));
  EXPECT_FALSE(anew_);
}

TEST_F(AGrowingLog, BeginsAnewWhereItIsAnotherOne) {
  append(kBegun + "{\"tap\": 1}\n{\"tap\": 2}\n");
  EXPECT_THAT(read(), ElementsAre(1, 2));
  folder_.write("record.jsonl", kBegun + "{\"tap\": 1, \"x\": 7}\n{\"tap\": 2}\n{\"tap\": 3}\n");  // same file
  EXPECT_THAT(read(), ElementsAre(1, 2, 3));
  EXPECT_TRUE(anew_);
  folder_.write("record.jsonl", kBegun + "{\"tap\": 1, \"x\": 7}\n");  // shorter file
  EXPECT_THAT(read(), ElementsAre(1));
  EXPECT_TRUE(anew_);
  fs::remove(file_);
  EXPECT_THAT(read(), IsEmpty());
  EXPECT_TRUE(anew_);
}

TEST_F(AGrowingLog, GoesOnWhereACopyWithMoreTakesItsPlace) {
  append(kBegun + "{\"tap\": 1}\n");
  EXPECT_THAT(read(), ElementsAre(1));
  folder_.write("copy", kBegun + "{\"tap\": 1}\n{\"tap\": 2}\n");  // the file is replaced, as by rsync
  fs::rename(folder_.path() / "copy", file_);
  EXPECT_THAT(read(), ElementsAre(2));
  EXPECT_FALSE(anew_);
}

TEST_F(AGrowingLog, SaysWhereTapsDoNotCountUpAcrossItsReads) {
  append(kBegun + "{\"tap\": 1}\n{\"tap\": 2}\n");
  EXPECT_THAT(read(), ElementsAre(1, 2));
  append("{\"tap\": 4}\n");
  EXPECT_THAT(test::error_of([&] { read(); }),
              testing::HasSubstr("record.jsonl:6: has tap 4 instead of tap 3: a line is missing"));
}

TEST_F(AGrowingLog, SaysWhatIsNoLineAndReadsAllOfItOnceThatIsPutRight) {
  append(kBegun + "{\"tap\": 1}\nnonsense\n");
  EXPECT_THROW(read(), Error);
  folder_.write("record.jsonl", kBegun + "{\"tap\": 1}\n{\"tap\": 2}\n");
  EXPECT_THAT(read(), ElementsAre(1, 2));
  log_.restart();
  EXPECT_THAT(read(), ElementsAre(1, 2));
}

/// A run made in this process.
class Watching : public ::testing::Test {
 protected:
  fs::path made(const std::string& base, const std::vector<std::string>& words = {}) const {
    const ResolvedConfig config = test::shipped_config(base, words);
    return start_run(environment_, config, folder_.path() / "run", {}).directory;
  }

  const test::TemporaryFolder folder_;
  const Installation installation_;
  const RunEnvironment environment_{test::shared_host(), installation_, {}, nullptr};
};

TEST_F(Watching, AHistoryThatGrowsIsAtEachTapThatOfARunThatEndsThere) {
  const RecordedRun whole = read_recorded_run(environment_.host, made("paper/object_i.yaml", {"taps=9"}));
  RecordedRun growing{whole.directory, whole.config, {whole.rows.front()}, {whole.taps.front()}, {}, {}, {}};
  HistoryBuilder builder(environment_, growing);
  builder.advance();
  for (std::size_t taps = 1;; ++taps) {
    RecordedRun until{whole.directory, whole.config, {}, {}, {}, {}, {}};
    until.rows.assign(whole.rows.begin(), whole.rows.begin() + static_cast<std::ptrdiff_t>(taps));
    until.taps.assign(whole.taps.begin(), whole.taps.begin() + static_cast<std::ptrdiff_t>(taps));
    const History expected = make_history(environment_, until, [](int, int) {});
    const History now = builder.since(0);
    ASSERT_EQ(now.moments.size(), taps + 1);
    ASSERT_EQ(now.maps.size(), expected.maps.size());
    for (std::size_t map = 0; map < now.maps.size(); ++map) {
      EXPECT_EQ(now.maps[map].name, expected.maps[map].name);
      EXPECT_EQ(now.maps[map].frames, expected.maps[map].frames) << taps;
    }
    EXPECT_EQ(now.moments.back().result.errors.rmse, expected.moments.back().result.errors.rmse);
    if (taps == whole.taps.size()) break;
    growing.rows.push_back(whole.rows[taps]);
    growing.taps.push_back(whole.taps[taps]);
    builder.advance();
  }
  const History last = builder.since(8);
  EXPECT_EQ(last.shown, (std::vector<int>{8, 9}));
  EXPECT_EQ(last.maps.front().frames.size(), 2U);
  EXPECT_EQ(last.moments.size(), 10U);
}

TEST_F(Watching, AHistoryThatIsThinnedKeepsTheLastMomentAndEverySecondOfTheOthers) {
  const RecordedRun recording = read_recorded_run(environment_.host, made("paper/object_i.yaml", {"taps=7"}));
  const History whole = make_history(environment_, recording, [](int, int) {});
  HistoryBuilder builder(environment_, recording);
  while (builder.taps() < 7) builder.advance();
  builder.thin(1000U << 20U);
  EXPECT_EQ(builder.since(0).shown.size(), 8U) << "few enough";
  builder.thin(1);
  const History now = builder.since(0);
  EXPECT_EQ(now.shown, (std::vector<int>{1, 3, 5, 7}));
  EXPECT_EQ(now.moments.size(), 8U);
  for (std::size_t i = 0; i < now.shown.size(); ++i)
    EXPECT_EQ(now.maps.front().frames.at(i), whole.maps.front().frames.at(static_cast<std::size_t>(now.shown[i])));
  EXPECT_EQ(now.maps.back().name, "truth");
  EXPECT_EQ(now.maps.back().frames.size(), 1U);
}

TEST_F(Watching, AServerThatIsLeftAloneEndsWhenItsPatienceDoes) {
  const fs::path directory = made("paper/object_i.yaml", {"taps=3"});
  Site site(environment_, directory);
  EXPECT_FALSE(site.goes_on());
  Server server(site, {"127.0.0.1", 0, 1});
  server.run();
  const RunDirectory held(directory);
  EXPECT_TRUE(site.goes_on()) << "then it would not have ended";
}

TEST_F(Watching, NoTwoServersHaveTheSameToken) {
  const fs::path directory = made("paper/object_i.yaml", {"taps=3"});
  Site site(environment_, directory);
  std::set<std::string> tokens;
  for (int i = 0; i < 20; ++i) {
    const std::string url = Server(site, {}).url();
    tokens.insert(url.substr(url.size() - 33));
  }
  EXPECT_EQ(tokens.size(), 20U);
}

}  // namespace
}  // namespace palpate
