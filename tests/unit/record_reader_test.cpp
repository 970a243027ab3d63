// SPDX-License-Identifier: MIT
// The laws of a record, each by a record that breaks it alone; and that a record which was cut anywhere is read and
// carried on.
#include "record/record_reader.hpp"

#include "record/fields.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "support/parts.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>

#include <fstream>
#include <numeric>

namespace palpate::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Lines = std::vector<std::string>;

const std::string kPutBack = ", put the file back as it was, or start again with 'palpate run --force'";

std::string joined(const Lines& lines) {
  return std::accumulate(lines.begin(), lines.end(), std::string(),
                         [](const std::string& a, const std::string& b) { return a + b + "\n"; });
}

TapRecord made(int number) {
  TapRecord out;
  out.request.number = number;
  out.request.line = line_from_above({0.1 * number, 0.05});
  out.result = contact_on(out.request.line, 0.09, 8.0, 5.5);
  out.reading.emplace().on_object = true;
  return out;
}

constexpr std::array<double, kPhases> kTook{0.5, 0.0, 0.25, 0.125, 0.0625};

/// Begins or carries on a run of so many taps, as a process does that may be killed at any time.
void carry_on(const fs::path& directory, bool announces, int taps) {
  RunDirectory run(directory);
  if (run.before().end && run.before().end->how == Ending::EndKind::done) return;
  if (!run.before().manifest) run.begin(Tree::map({{"build", Tree::quote("b")}}));
  run.begin_attempt("b", false);
  run.set_up(announces, Tree::map());
  for (auto i = static_cast<int>(run.recover().size()) + 1; i <= taps; ++i) {
    run.announce(made(i));
    run.record(made(i), kTook);
  }
  run.write_made(kTapsTable, to_csv(run.rows()));
  Row object;
  object.add("object", std::int64_t{0});
  object.add("type", std::string("cube"));
  run.write_objects({object});
  Row summary;
  summary.add("status", "done");
  summary.add("taps", std::int64_t{taps});
  run.end({Ending::EndKind::done, "tap budget", summary, {}});
}

class Record : public InFolder {
 protected:
  fs::path file() const { return folder_.path() / "run" / kRecordFile; }
  fs::path run() const { return file().parent_path(); }
  /// What is said of a record of these lines, behind the name of its file; "" if it is read.
  std::string refusal(const std::string& text) const {
    folder_.write("run/record.jsonl", text);
    const std::string said = error_of([&] { read_run_record(run()); });
    return said == "accepted" ? "" : said.substr(file().string().size());
  }
};

/// The lines of a record with two attempts, and where each of its parts is.
struct Sound {
  static constexpr std::size_t kSetup = 2, kIntent = 3, kTap = 4, kTiming = 5, kAttempt = 6, kLastTap = 9, kEnd = 12;
  Lines lines{R"({"manifest": 1, "build": "b"})",
              R"({"attempt": 1, "after_tap": 0})",
              R"({"setup": 1, "announces": true, "models": {}})",
              R"({"intent": 1, "x": 1})",
              R"({"tap": 1, "x": 1})",
              R"({"timing": 1, "robot": 1, "fit": 0, "infer": 0, "acquire": 0, "log": 0})",
              R"({"attempt": 2, "after_tap": 1})",
              R"({"setup": 2, "announces": true, "models": {"height": ["you"]}})",
              R"({"intent": 2, "x": 2})",
              R"({"tap": 2, "x": 2})",
              R"({"timing": 2, "robot": 2, "fit": 0, "infer": 0, "acquire": 0, "log": 0})",
              R"({"objects": [{"object": 0, "type": "cube"}]})",
              R"({"end": "done", "attempt": 2, "reason": "tap budget", "summary": {"taps": 2}, "files": {}})"};
  std::string without(std::size_t line) const {
    Lines out = lines;
    out.erase(out.begin() + static_cast<std::ptrdiff_t>(line));
    return joined(out);
  }
  std::string with(std::size_t line, const std::string& text) const {
    Lines out = lines;
    out.insert(out.begin() + static_cast<std::ptrdiff_t>(line), text);
    return joined(out);
  }
  std::string instead(std::size_t line, const std::string& text) const {
    Lines out = lines;
    out[line] = text;
    return joined(out);
  }
  std::string first(std::size_t count) const {
    return joined({lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(count)});
  }
};

TEST_F(Record, ThatIsSoundHasEachOfItsParts) {
  const Sound sound;
  ASSERT_EQ(refusal(joined(sound.lines)), "");
  const RunRecord record = read_run_record(run());
  EXPECT_EQ(record.build(), "b");
  ASSERT_EQ(record.attempts.size(), 2U);
  EXPECT_EQ(record.attempts[0].find("end"), nullptr) << "it was killed";
  EXPECT_EQ(record.attempts[1].text("end"), "done");
  EXPECT_EQ(record.setup->find("models")->find("height")->items[0].text, "you");
  ASSERT_EQ(record.taps.size(), 2U);
  EXPECT_EQ(record.taps[1].number("x"), 2.0);
  EXPECT_FALSE(record.intent);
  ASSERT_EQ(record.timings.size(), 2U);
  EXPECT_EQ(record.timings[1].tap, 2);
  EXPECT_EQ(record.timings[1].seconds[0], 2.0);
  EXPECT_EQ(record.objects.at(0).text("type"), "cube");
  EXPECT_EQ(record.end->how, Ending::EndKind::done);
  EXPECT_EQ(record.end->summary.number("taps"), 2.0);
}

TEST_F(Record, Law1BeginsWithItsManifestAndHasNoOther) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.without(0)), ":1: is not the manifest, which must be the first line" + kPutBack);
  EXPECT_EQ(refusal(sound.with(0, "{}")), ":1: is not the manifest, which must be the first line" + kPutBack);
  EXPECT_EQ(refusal(sound.with(1, sound.lines[0])), ":2: is a second manifest" + kPutBack);
}

TEST_F(Record, Law2CountsItsAttemptsWithTheirTapsAndSetsEachUp) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.without(1)), ":2: does not follow its attempt: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.without(Sound::kSetup)),
            ":3: has tap 1 before its attempt was set up: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.with(2, R"({"attempt": 3, "after_tap": 0})")),
            ":3: has attempt 3 instead of attempt 2: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.first(3) + R"({"attempt": 2, "after_tap": 1})"
                                     "\n"),
            ":4: starts after tap 1, but the taps before it are 0: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.without(Sound::kAttempt)), ":7: does not follow its attempt: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.first(2) + R"({"attempt": 2, "after_tap": 0})"
                                     "\n"),
            "")
      << "killed while it was built";
}

TEST_F(Record, Law3CountsItsTaps) {
  const Sound sound;
  const std::string begun = begun_record();
  EXPECT_EQ(refusal(begun + "{\"tap\": 1}\n{\"tap\": 2}\n"), "");
  EXPECT_EQ(refusal(begun + "{\"tap\": 2}\n"), ":4: has tap 2 instead of tap 1: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(begun + "{\"tap\": 1}\n{\"tap\": 1}\n"), ":5: has tap 1 a second time instead of tap 2" + kPutBack);
  for (const char* number : {"\"2\"", "2.5", "null", "true", "-1", "0"})
    EXPECT_NE(refusal(begun + "{\"tap\": 1}\n{\"tap\": " + number + "}\n"), "") << number;
}

TEST_F(Record, Law4AnnouncesItsTapsWhereTheyCannotBeRepeated) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.without(Sound::kIntent)),
            ":4: has tap 1, which was not announced: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.with(Sound::kIntent, sound.lines[Sound::kIntent])),
            ":5: announces tap 1 a second time" + kPutBack);
  EXPECT_EQ(refusal(sound.with(Sound::kTiming, sound.lines[Sound::kIntent])),
            ":6: announces tap 1, which is recorded already" + kPutBack);
  EXPECT_EQ(refusal(sound.first(Sound::kTap)), "");
  EXPECT_TRUE(read_run_record(run()).intent);
  EXPECT_EQ(refusal(sound.first(Sound::kTap) +
                    R"({"note": "learnt"})"
                    "\n" +
                    R"({"end": "failed"})"
                    "\n" +
                    R"({"attempt": 2, "after_tap": 0})"
                    "\n" +
                    R"({"setup": 2, "announces": true})"
                    "\n" +
                    R"({"tap": 1})"
                    "\n"),
            "");
}

TEST_F(Record, Law5HasTheTimesOfATapBehindIt) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.without(Sound::kTiming)), "") << "a kill may lose them";
  EXPECT_EQ(refusal(sound.with(Sound::kAttempt, sound.lines[Sound::kTiming])),
            ":7: has the times of tap 1, but does not follow that tap" + kPutBack);
  EXPECT_EQ(refusal(sound.instead(Sound::kTiming, R"({"timing": 1, "robot": "long"})")),
            ":6: has no number 'robot'" + kPutBack);
}

TEST_F(Record, Law6HasNothingBehindAnEndThatIsDone) {
  const Sound sound;
  for (const char* line : {R"({"note": "x"})", R"({"attempt": 3, "after_tap": 2})", R"({"end": "done"})"})
    EXPECT_EQ(refusal(joined(sound.lines) + line + "\n"), ":14: follows the end of a finished run" + kPutBack);
  EXPECT_EQ(refusal(sound.first(6) + R"({"end": "done", "summary": {"taps": 2}})"
                                     "\n"),
            ":7: ends a run of 2 taps, but the taps before it are 1: a line is missing" + kPutBack);
  EXPECT_EQ(refusal(sound.without(Sound::kLastTap)).substr(0, 3), ":10");
  for (const char* how : {"failed", "interrupted"}) {
    const std::string ended = sound.first(6) + fmt::format("{{\"end\": \"{}\"}}\n", how);
    EXPECT_EQ(refusal(ended + R"({"attempt": 2, "after_tap": 1})"
                              "\n"),
              "");
    EXPECT_EQ(refusal(ended + R"({"note": "x"})"
                              "\n"),
              ":8: follows the end of an attempt but does not start a new one" + kPutBack);
  }
  EXPECT_THAT(refusal(sound.first(6) + R"({"end": "well"})"
                                       "\n"),
              HasSubstr(":7: has no 'end' with done, failed"));
}

TEST_F(Record, Law7LeavesOutALastLineWithoutItsEndAndNoOther) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.first(6) + R"({"attempt": 2, "aft)"), "");
  EXPECT_EQ(read_run_record(run()).attempts.size(), 1U);
  EXPECT_EQ(refusal(sound.first(6) + "{\"attempt\": 2, \"aft{\"attempt\": 2, \"after_tap\": 1}\n"),
            ":7: is not a JSON object, the file is damaged");
}

TEST_F(Record, Law8IsCutWhereASummaryIsThereWithoutItsEnd) {
  const Sound sound;
  folder_.write("run/summary.json", "{}");
  folder_.write("run/record.jsonl", sound.first(12));
  EXPECT_TRUE(read_record(run()).cut);
  EXPECT_EQ(read_record(run()).state, RunStatus::State::unfinished) << "not the presence of a file decides";
  folder_.write("run/record.jsonl", joined(sound.lines));
  EXPECT_FALSE(read_record(run()).cut);
}

TEST_F(Record, WhoseLinesAreMissingDoubledOrSwappedIsRefused) {
  const Sound sound;
  for (std::size_t i = 0; i < sound.lines.size(); ++i) {
    const std::string kind = sound.lines[i].substr(2, sound.lines[i].find('"', 2) - 2);
    // Nothing depends on times and objects; without an end it is a run that was broken off.
    const bool may_be_lost = kind == "timing" || kind == "objects" || kind == "end";
    EXPECT_EQ(refusal(sound.without(i)).empty(), may_be_lost) << i;
    EXPECT_EQ(refusal(sound.with(i, sound.lines[i])).empty(), kind == "objects") << i;
    if (i + 1 == sound.lines.size()) continue;
    Lines swapped = sound.lines;
    std::swap(swapped[i], swapped[i + 1]);
    EXPECT_NE(refusal(joined(swapped)), "") << i;
  }
}

TEST_F(Record, OfALaterPalpateKeepsWhatThisOneDoesNotKnow) {
  const Sound sound;
  for (std::size_t i = 1; i < sound.lines.size(); ++i)
    EXPECT_EQ(refusal(sound.with(i, R"({"weather": ["rain", {"mm": 3}], "tap": 7})")), "") << i;
  EXPECT_EQ(refusal(sound.with(2, R"({"weather": [)")), ":3: is not a JSON object, the file is damaged");
  // Another phase of a tap, and none of an earlier palpate.
  EXPECT_EQ(refusal(sound.instead(Sound::kTiming, R"({"timing": 1, "robot": 0.5, "ponder": 0.1})")), "");
}

TEST_F(Record, WhoseVersionIsNoNumberIsNotTakenForALaterOne) {
  const Sound sound;
  EXPECT_EQ(refusal(sound.instead(0, R"({"manifest": "x"})")), ":1: has no version 'manifest'" + kPutBack);
  EXPECT_EQ(refusal(sound.instead(0, R"({"manifest": 0})")), ":1: has no version 'manifest'" + kPutBack);
  EXPECT_EQ(
      refusal(sound.instead(0, R"({"manifest": 2})")),
      ":1: has a later version than this palpate can read, use a palpate at least as new as the one that wrote it");
}

TEST_F(Record, NamesNoFileOutsideItsFolder) {
  const Sound sound;
  for (const char* name : {"../x", "/etc/passwd", "..", ".", "", "maps/x"}) {
    const std::string end =
        fmt::format(R"({{"end": "failed", "files": {{"{}": {{"bytes": 1, "hash": "0"}}}}}})", name) + "\n";
    EXPECT_THAT(refusal(sound.first(3) + end), HasSubstr(", or names a file that is not in its folder" + kPutBack))
        << name;
    EXPECT_THAT(error_of([&] { read_record_end(run()); }),
                HasSubstr(", or names a file that is not in its folder" + kPutBack));
  }
}

TEST_F(Record, TellsHowItEndedByItsLastLineHoweverLong) {
  const Sound sound;
  for (const std::size_t length : {1U, 3900U, 4096U, 20000U, 200000U}) {
    std::string end = sound.lines.back();
    end.insert(end.find("tap budget"), std::string(length, 'x'));
    for (const std::string& behind : {std::string("\n"), std::string("\n{\"half")}) {
      folder_.write("run/record.jsonl", sound.first(12) + end + behind);
      EXPECT_EQ(read_record_end(run()).end->reason.size(), length + 10) << length;
    }
    folder_.write("run/record.jsonl", sound.first(12) + "{\"note\": \"" + std::string(length, 'x') + "\"}\n");
    EXPECT_FALSE(read_record_end(run()).end);
    EXPECT_TRUE(read_record_end(run()).begun);
  }
  folder_.write("run/record.jsonl", "{\"manifest\": 1");
  EXPECT_FALSE(read_record_end(run()).begun);
  fs::remove(file());
  EXPECT_FALSE(read_record_end(run()).begun);
}

TEST_F(Record, CountsAttemptsSinceTheLastThatEnded) {
  const auto attempts = [&](const char* text) {
    folder_.write("run/record.jsonl", text);
    return attempts_in_row(run());
  };
  const std::string attempt = "{\"attempt\": 1}\n";
  const std::string failed = "{\"end\": \"failed\"}\n";
  EXPECT_EQ(attempts(""), 0);
  EXPECT_EQ(attempts((attempt + attempt + attempt).c_str()), 3);
  EXPECT_EQ(attempts((attempt + attempt + failed).c_str()), 2) << "the last ones";
  EXPECT_EQ(attempts((attempt + attempt + failed + attempt).c_str()), 1) << "tried again";
  EXPECT_EQ(attempts((attempt + "{\"end\": \"interrupted\"}\n" + attempt).c_str()), 1) << "that was no kill";
}

TEST_F(Record, ThatIsCutAnywhereIsReadAndCarriedOnToTheSameTaps) {
  for (const bool announces : {false, true}) {
    fs::remove_all(run());
    carry_on(run(), announces, 2);
    const std::string whole = text_of(file());
    const std::string taps = part_of(run(), "tap");
    const std::string table = text_of(run() / "taps.csv");
    for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
      // At, before and behind each end of a line, and at some places within.
      const bool near_end = whole.substr(cut - std::min<std::size_t>(cut, 2), 3).find('\n') != std::string::npos;
      if (!near_end && cut % 61 != 0) continue;
      std::ofstream(file()) << whole.substr(0, cut);
      ASSERT_EQ(error_of([&] { read_record(this->run()); }), "accepted") << cut;
      carry_on(run(), announces, 2);
      const RunRecord after = read_run_record(run());
      ASSERT_EQ(after.taps.size(), 2U) << cut;
      EXPECT_EQ(after.end->how, Ending::EndKind::done) << cut;
      std::string expected = taps;
      // Nobody saw the end of a tap that was announced.
      for (std::size_t i = 0; announces && i < 2; ++i) {
        if (after.taps[i].text("outcome") != "unknown") continue;
        const std::string line = to_json_line(after.taps[i]) + "\n";
        const std::size_t at = expected.find(fmt::format("{{\"tap\": {},", i + 1));
        expected.replace(at, expected.find('\n', at) + 1 - at, line);
      }
      EXPECT_EQ(part_of(run(), "tap"), expected) << cut;
      if (!announces) {
        EXPECT_EQ(text_of(run() / "taps.csv"), table) << cut;
      }
      EXPECT_EQ(text_of(run() / "summary.json"), to_json(after.end->summary)) << cut;
      const bool half = cut > 0 && cut < whole.size() && whole[cut - 1] != '\n';
      EXPECT_EQ(after.attempts.back().find("cut") != nullptr, half) << cut;
    }
  }
}

}  // namespace
}  // namespace palpate::test
