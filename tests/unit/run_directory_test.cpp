// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "children/child_process.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "support/parts.hpp"
#include "support/shortage.hpp"
#include "support/testing.hpp"

#include <fstream>
#include <memory>

#include <unistd.h>

namespace palpate::test {
namespace {

TapRecord tap(int number, double height) {
  TapRecord out;
  out.request.number = number;
  out.request.line = line_from_above({0.1 * number, 0.05});
  out.result = contact_on(out.request.line, height, 8.0, 5.5);
  out.reading.emplace().on_object = height > 0.01;
  return out;
}

constexpr std::array<double, kPhases> kSeconds{0.5, 0.0, 0.25, 0.125, 0.0625};

/// Begins a run, or an attempt at it, as far as its first tap.
void set_up(RunDirectory& run, bool announce) {
  if (!run.before().manifest) run.begin(Tree::map());
  run.begin_attempt("b", false);
  run.set_up(announce, Tree::map());
}

/// Writes three taps as a living run does.
void write_three(const fs::path& directory, bool announce) {
  RunDirectory run(directory);
  set_up(run, announce);
  for (int i = 1; i <= 3; ++i) {
    run.announce(tap(i, 0.09));
    run.record(tap(i, 0.09), kSeconds);
  }
}

void append(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::app) << text; }

using RunFolder = InFolder;

TEST_F(RunFolder, RecoversTheTapsThatWereRecorded) {
  for (const bool announce : {false, true}) {
    const fs::path run = folder_.path() / (announce ? "announced" : "plain");
    write_three(run, announce);
    RunDirectory again(run);
    const std::vector<TapRecord> past = again.recover();
    ASSERT_EQ(past.size(), 3U);
    EXPECT_EQ(past[1].target().x, 0.2);
    EXPECT_EQ(past[1].result.height(), 0.09);
    EXPECT_EQ(past[1].result.outcome, Outcome::contact);
    EXPECT_EQ(again.rows().size(), 3U);
    EXPECT_DOUBLE_EQ(again.total_seconds()[0], 1.5);
    EXPECT_DOUBLE_EQ(again.total_seconds()[4], 0.1875);
  }
}

TEST_F(RunFolder, AnIntentWithoutResultBecomesATapOfUnknownOutcomeOnce) {
  write_three(folder_.path() / "run", true);
  append(folder_.path() / "run" / "record.jsonl", to_json_line(intent_row(tap(4, 0.0))) + "\n");
  for (int i = 0; i < 2; ++i) {
    RunDirectory run(folder_.path() / "run");
    set_up(run, true);
    const std::vector<TapRecord> past = run.recover();
    ASSERT_EQ(past.size(), 4U);
    EXPECT_EQ(past[3].result.outcome, Outcome::unknown);
    EXPECT_EQ(past[3].target().x, 0.4);
  }
}

/// Every way of writing there, each refused with `words`.
void expect_nothing_is_written(RunDirectory& run, const std::string& words) {
  using testing::StartsWith;
  const auto words_of = [](const auto& write) { return error_of(write, Error::Kind::run); };
  EXPECT_THAT(words_of([&] { run.announce(tap(2, 0.09)); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.record(tap(2, 0.09), kSeconds); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write("summary.json", std::string("{}")); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.begin(Tree::map()); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.begin_attempt("b", false); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.set_up(true, Tree::map()); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.note_learnt("a", "b"); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write_objects({Row()}); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.end({Ending::EndKind::done, "", {}, {}}); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write_made("taps.csv", ""); }), StartsWith(words));
}

TEST_F(RunFolder, IsWrittenToByNobodyWhoseRecordWasRemovedOrTakenOver) {
  const fs::path folder = folder_.path() / "run";
  const fs::path record = folder / "record.jsonl";
  RunDirectory run(folder);
  set_up(run, true);
  run.announce(tap(1, 0.09));
  run.record(tap(1, 0.09), kSeconds);
  const std::string recorded = text_of(record);
  fs::rename(record, folder_.path() / "kept");
  expect_nothing_is_written(run, folder.string());
  fs::copy_file(folder_.path() / "kept", record);
  {
    RunDirectory other(folder);
    EXPECT_EQ(other.recover().size(), 1U);
    expect_nothing_is_written(run, folder.string());
  }
  EXPECT_EQ(text_of(record), recorded);
  EXPECT_EQ(text_of(folder_.path() / "kept"), recorded);
  EXPECT_FALSE(fs::exists(folder / "summary.json"));
}

TEST_F(RunFolder, TakesTheResultOfATapWhereverItsFolderWasMovedMeanwhile) {
  RunDirectory run(folder_.path() / "run");
  set_up(run, true);
  run.announce(tap(1, 0.09));
  fs::rename(folder_.path() / "run", folder_.path() / "moved");
  run.record(tap(1, 0.09), kSeconds);
  EXPECT_EQ(read_run_record(folder_.path() / "moved").taps.size(), 1U);
  EXPECT_THAT(error_of([&] { run.announce(tap(2, 0.09)); }, Error::Kind::run),
              testing::HasSubstr("was moved or removed while a run was writing there"));
  // Files are written by their path, which may be another run's by now.
  fs::create_directory(folder_.path() / "run");
  EXPECT_THAT(error_of([&] { run.write("maps.csv", std::string("x")); }, Error::Kind::run),
              testing::HasSubstr("was moved or removed while a run was writing there"));
  EXPECT_TRUE(fs::is_empty(folder_.path() / "run"));
}

TEST_F(RunFolder, KeepsATapForWhoseTimesTheDiskHasNoRoom) {
  const fs::path directory = folder_.path() / "run";
  write_three(directory, true);
  const fs::path file = directory / kRecordFile;
  const std::uintmax_t before = fs::file_size(file);
  RunDirectory run(directory);
  set_up(run, true);
  ASSERT_EQ(run.recover().size(), 3U);
  run.announce(tap(4, 0.09));
  const std::uintmax_t announced = fs::file_size(file);
  const std::uintmax_t line = to_json_line(tap_row(tap(4, 0.09))).size() + 1;
  EXPECT_THAT(with_little_room(announced + line + 10, [&] { run.record(tap(4, 0.09), kSeconds); }),
              testing::HasSubstr("cannot be written: File too large"));
  EXPECT_GT(announced, before);
  EXPECT_EQ(run.rows().size(), 4U);
  const RunRecord record = read_run_record(directory);
  EXPECT_EQ(record.taps.size(), 4U);
  EXPECT_EQ(record.timings.size(), 3U);
  EXPECT_FALSE(record.intent);
}

TEST_F(RunFolder, RemovesNothingThroughALinkInThePlaceOfItsMaps) {
  const fs::path victim = folder_.write("elsewhere/x.0123456789abcdef.tmp", "mine");
  fs::create_directory(folder_.path() / "run");
  fs::create_directory_symlink(victim.parent_path(), folder_.path() / "run" / "maps");
  const RunDirectory run(folder_.path() / "run");
  EXPECT_TRUE(fs::exists(victim));
}

TEST_F(RunFolder, IsWrittenToByNoForkedChildAndFreeAgainThoughThatLives) {
  const fs::path folder = folder_.path() / "run";
  auto run = std::make_unique<RunDirectory>(folder);
  set_up(*run, true);
  run->announce(tap(1, 0.09));
  run->record(tap(1, 0.09), kSeconds);
  const std::string recorded = text_of(folder / "record.jsonl");
  const auto child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    expect_nothing_is_written(*run, folder.string() + ": is held by the parent of this forked process");
    say(testing::Test::HasFailure() ? "written" : "refused");
    return ::pause();
  });
  while (child->said().empty() && !child->wait(0.001)) {
  }
  EXPECT_EQ(child->said(), "refused");
  EXPECT_EQ(text_of(folder / "record.jsonl"), recorded);
  EXPECT_TRUE(is_running(folder));
  run.reset();
  EXPECT_FALSE(is_running(folder));
}

TEST_F(RunFolder, RefusesADamagedLineWithItsNumber) {
  write_three(folder_.path() / "run", false);
  std::string text = text_of(folder_.path() / "run" / "record.jsonl");
  text[text.find("{\"tap\": 2") + 30] = '\n';
  folder_.write("run/record.jsonl", text);
  RunDirectory run(folder_.path() / "run");
  EXPECT_THAT(error_of([&] { run.recover(); }), testing::HasSubstr("record.jsonl:6: is not a JSON object"));
}

TEST_F(RunFolder, RefusesALineThatIsNoTap) {
  folder_.write(
      "run/record.jsonl",
      begun_record() + "{\"tap\": 1, \"source\": \"initial\", \"x\": \"here\", \"y\": 0, \"outcome\": \"contact\"}\n");
  RunDirectory run(folder_.path() / "run");
  EXPECT_THROW(run.recover(), Error);
}

TEST_F(RunFolder, TellsItsStateFromItsRecordAlone) {
  const fs::path directory = folder_.path() / "run";
  EXPECT_EQ(read_status(directory).state, RunStatus::State::absent);
  write_three(directory, true);
  EXPECT_EQ(read_status(directory).state, RunStatus::State::unfinished);
  EXPECT_EQ(read_status(directory).taps, 3);
  {
    const RunDirectory held(directory);
    EXPECT_EQ(read_status(directory).state, RunStatus::State::running);
  }
  RunDirectory(directory).fail("the arm was stopped");
  EXPECT_EQ(read_status(directory).state, RunStatus::State::failed);
  EXPECT_EQ(read_status(directory).stop_reason, "the arm was stopped");
  {
    RunDirectory run(directory);
    set_up(run, true);
    EXPECT_EQ(run.recover().size(), 3U);
    Row summary;
    summary.add("taps", 3);
    run.end({Ending::EndKind::done, "tap budget", summary, {}});
  }
  EXPECT_EQ(read_status(directory).state, RunStatus::State::done);
  EXPECT_FALSE(lacks_files(directory, *read_ending(directory).end));
  folder_.write("run/summary.json", "");
  EXPECT_TRUE(lacks_files(directory, *read_ending(directory).end)) << "a power cut leaves empty files";
  fs::remove(directory / "summary.json");
  EXPECT_EQ(read_status(directory).state, RunStatus::State::done) << "that is a copy";
  EXPECT_TRUE(lacks_files(directory, *read_ending(directory).end));
}

TEST_F(RunFolder, CanBeEndedAsFailedAtAnyTime) {
  for (int steps = 0; steps < 5; ++steps) {
    const fs::path directory = folder_.path() / std::to_string(steps);
    {
      RunDirectory run(directory);
      if (steps > 0) run.begin(Tree::map());
      if (steps > 1) run.begin_attempt("b", false);
      if (steps > 2) run.set_up(true, Tree::map());
      if (steps > 3) run.announce(tap(1, 0.09));
      run.fail("the first time");
    }
    EXPECT_EQ(read_run_record(directory).end->reason, "the first time") << steps;
    EXPECT_EQ(read_run_record(directory).is_failure_alone(), steps < 2);
    RunDirectory(directory).fail("the second time");
    const RunRecord record = read_run_record(directory);
    EXPECT_EQ(record.end->how, Ending::EndKind::failed) << steps;
    EXPECT_EQ(record.end->summary.text("stop_reason"), "the second time");
    EXPECT_EQ(record.intent.has_value(), steps > 3);
  }
}

TEST(TapRow, ReadsBackAsTheTapThatItTells) {
  TapRecord record = tap(5, 0.1 + 0.2);
  record.request.source = Source::fallback;
  record.why = "no score is positive";
  const Row row = *parse_json_row(to_json_line(tap_row(record)));
  const TapRecord back = read_taps({row}, "here").front();
  EXPECT_EQ(back.request.source, Source::fallback);
  EXPECT_EQ(back.why, record.why);
  EXPECT_EQ(back.target().x, record.target().x);
  EXPECT_EQ(back.result.height(), 0.1 + 0.2) << "to the last bit";
}

TEST(TapRow, AnIntentHoldsNoResult) {
  const Row row = intent_row(tap(1, 0.0));
  EXPECT_EQ(row.fields.front().first, "intent");
  EXPECT_EQ(unknown_result_of(row).fields.front().first, "tap");
  EXPECT_EQ(*unknown_result_of(row).find("outcome"), Scalar{std::string("unknown")});
}

}  // namespace
}  // namespace palpate::test
