// SPDX-License-Identifier: MIT
// Pages of `palpate watch` in a browser while their record grows.
#include "report/browser.hpp"
#include "support/parts.hpp"
#include "support/programs.hpp"

#include <fmt/format.h>

#include <fstream>
#include <memory>

namespace palpate {
namespace {

using test::eventually;
using ::testing::IsEmpty;

class LivePage : public test::Reports {
 protected:
  /// Makes a run of 17 taps with a record of the first `taps`. Returns its directory.
  fs::path under_way(std::size_t taps) {
    const test::Ended ran = test::palpate({"run", paper_, "--quiet", "seed=4"}, folder_.path());
    EXPECT_EQ(ran.status, 0) << ran.err;
    directory_ = test::only_run(folder_.path() / "runs");
    whole_ = folder_.path() / "whole";
    fs::copy(directory_, whole_, fs::copy_options::recursive);
    fs::remove(directory_ / "summary.json");
    fs::remove(directory_ / "record.jsonl");
    std::ofstream(directory_ / "record.jsonl")
        << test::record_until(test::text_of(whole_ / "record.jsonl"), static_cast<int>(taps));
    return directory_;
  }
  /// Returns a step that appends taps `first` to `last` to the record.
  std::string grow(std::size_t first, std::size_t last) const {
    std::string patterns;
    for (std::size_t tap = first; tap <= last; ++tap) patterns += fmt::format(" -e '^.\"t[a-z]*\": {},'", tap);
    return fmt::format("shell grep -h{} {} >> {}", patterns, (whole_ / "record.jsonl").string(),
                       (directory_ / "record.jsonl").string());
  }
  std::string serve(const fs::path& directory) {
    server_ = std::make_unique<test::Child>(
        std::vector<std::string>{test::program_file().string(), "watch", directory.string()}, folder_.path());
    EXPECT_TRUE(eventually([&] { return server_->out().find('\n') != std::string::npos || !server_->running(); }));
    const std::string line = server_->out();
    return line.substr(0, line.find('\n'));
  }

  fs::path directory_;
  fs::path whole_;
  std::unique_ptr<test::Child> server_;
};

/// A reload would remove the mark.
const std::string kMark = "window.mark = 'still here'; return window.mark";
const std::string kMarked = "return window.mark";
const std::string kAt = "return [document.getElementById('at').textContent, document.getElementById('slider').max]";

std::string slide(int tap) {
  return fmt::format(
      "const s = document.getElementById('slider'); s.value = {}; s.dispatchEvent(new Event('input')); return {};", tap,
      tap);
}
const std::string kSame = "await document.getElementById('at').textContent === 'after tap 2 of 16'";
const std::string kSixteenKnown = "await document.getElementById('slider').max === '16'";

TEST_F(LivePage, ShowsATapThatIsRecordedWithoutBeingLoadedAgainAndStaysWhereItsReaderPutIt) {
  const std::string url = serve(under_way(5));
  const Browsed seen =
      test::browse(url,
                   {drawn(5), kMark, grow(6, 6), drawn(6), kAt, slide(2), drawn(2), grow(7, 16), kSixteenKnown, kSame,
                    kAt, "return document.getElementById('curve_0').data[0].x.length", slide(16), drawn(16), kAt,
                    grow(17, 17), drawn(17), kMarked, "return document.getElementById('live').textContent"},
                   false);
  ASSERT_EQ(seen.trouble, "");
  EXPECT_THAT(seen.severe, IsEmpty());
  EXPECT_EQ(seen.values.at(1), (json{"after tap 6 of 6", "6"}));
  EXPECT_EQ(seen.values.at(3), (json{"after tap 2 of 16", "16"}));
  EXPECT_EQ(seen.values.at(6), (json{"after tap 16 of 16", "16"}));
  EXPECT_EQ(seen.values.at(7), "still here");
  EXPECT_EQ(seen.values.at(8), "live");
}

TEST_F(LivePage, BeginsWithTheFirstTapAndSaysWhenItsServerIsGone) {
  const std::string url = serve(under_way(0));
  const Browsed seen = test::browse(
      url,
      {"await document.getElementById('waiting') !== null", grow(1, 2), drawn(2), kAt,
       fmt::format("shell kill {}", server_->pid()),
       "await document.getElementById('live').textContent === 'not connected'", "key ARROW_LEFT", drawn(1), kAt},
      true);
  ASSERT_EQ(seen.trouble, "");
  EXPECT_EQ(seen.values.at(0), (json{"after tap 2 of 2", "2"}));
  EXPECT_EQ(seen.values.at(1), (json{"after tap 1 of 2", "2"})) << "what was shown can be read on";
  EXPECT_EQ(server_->wait().status, 0);
}

TEST_F(LivePage, OfASweepFillsUpAndItsReaderKeepsWhatWasChosen) {
  const test::Ended swept = test::palpate({"sweep", paper_, "seed=range(0,2)", "taps=5", "--quiet"}, folder_.path());
  ASSERT_EQ(swept.status, 0) << swept.err;
  const fs::path sweep = test::only_run(folder_.path() / "runs");
  const fs::path job = sweep / "jobs" / csv_rows(text_of(sweep / "results.csv")).at(1).at("id");
  fs::copy_file(job / "record.jsonl", folder_.path() / "ended");
  test::forget_end(job);
  const auto done = [](int count) {
    return fmt::format("await document.getElementById('standing').textContent.includes('{}done')", count);
  };
  const Browsed seen = test::browse(
      serve(sweep),
      {drawn(1), kMark, done(1),
       "const s = document.getElementById('metric'); s.value = 'taps'; s.dispatchEvent(new Event('change')); return 1",
       fmt::format("shell mv {} {}", (folder_.path() / "ended").string(), (job / "record.jsonl").string()), done(2),
       kMarked, "return document.getElementById('metric').value"},
      false);
  ASSERT_EQ(seen.trouble, "");
  EXPECT_THAT(seen.severe, IsEmpty());
  EXPECT_EQ(seen.values.at(2), "still here");
  EXPECT_EQ(seen.values.at(3), "taps");
}

TEST_F(LivePage, OfAFileOrAServerPlaysItsTapsOneByOne) {
  under_way(17);
  report(directory_);
  const std::string watch_it =
      "window.seen = []; new MutationObserver(() => window.seen.push(Number(document.body.dataset.drawn)))"
      ".observe(document.body, {attributes: true, attributeFilter: ['data-drawn']})";
  const std::string press = "document.getElementById('play').click()";
  const std::string sign = "return document.getElementById('play').getAttribute('aria-label')";
  for (const std::string& page : {(directory_ / "report.html").string(), serve(directory_)}) {
    const Browsed seen = test::browse(
        page,
        {drawn(17), slide(13), drawn(13), sign, watch_it, press, sign, drawn(17), "return window.seen",
         "await document.getElementById('play').ariaLabel === 'play'", press, drawn(1), slide(8), drawn(8), sign},
        false);
    ASSERT_EQ(seen.trouble, "") << page;
    EXPECT_THAT(seen.severe, IsEmpty()) << page;
    const std::vector<json> values(seen.values.begin(), seen.values.end());
    EXPECT_THAT(values, ::testing::IsSupersetOf({json("play"), json("pause"), json({14, 15, 16, 17})})) << page;
    EXPECT_EQ(seen.values.back(), "play") << "who moves the slider stops it";
  }
}

}  // namespace
}  // namespace palpate
