// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "children/child_process.hpp"
#include "record/json.hpp"
#include "record/tap_row.hpp"
#include "support/testing.hpp"

#include <fstream>
#include <memory>

#include <unistd.h>

namespace palpate::test {
namespace {

TapRecord tap(int number, double height) {
  TapRecord out;
  out.number = number;
  out.target = {0.1 * number, 0.05};
  out.contact = {Outcome::contact, height, 8.0, 5.5, {}};
  out.on_surface = height > 0.01;
  return out;
}

constexpr std::array<double, kPhases> kSeconds{0.5, 0.0, 0.25, 0.125, 0.0625};

/// Writes three taps as a living run does.
void write_three(const fs::path& directory, bool announce) {
  RunDirectory run(directory);
  run.open(announce);
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
    const std::vector<PastTap> past = again.recover();
    ASSERT_EQ(past.size(), 3U);
    EXPECT_EQ(past[1].target.x, 0.2);
    EXPECT_EQ(past[1].contact.height, 0.09);
    EXPECT_EQ(past[1].contact.outcome, Outcome::contact);
    EXPECT_EQ(again.rows().size(), 3U);
    EXPECT_DOUBLE_EQ(again.total_seconds()[0], 1.5);
    EXPECT_DOUBLE_EQ(again.total_seconds()[4], 0.1875);
  }
}

TEST_F(RunFolder, CutsOffHalfALineAtEveryLength) {
  write_three(folder_.path() / "whole", false);
  const std::string whole = text_of(folder_.path() / "whole" / "taps.jsonl");
  const auto second_end = whole.find('\n', whole.find('\n') + 1) + 1;
  for (std::size_t cut = second_end; cut < whole.size(); cut += 7) {
    const fs::path file = folder_.write("cut/taps.jsonl", whole.substr(0, cut));
    {
      RunDirectory run(folder_.path() / "cut");
      EXPECT_EQ(run.recover().size(), 2U) << cut;
      EXPECT_EQ(text_of(file), whole.substr(0, second_end));
      run.open(false);
      run.record(tap(3, 0.09), kSeconds);
    }
    EXPECT_EQ(text_of(file), whole) << "what follows begins on a line of its own";
    fs::remove_all(folder_.path() / "cut");
  }
}

TEST_F(RunFolder, AnIntentWithoutResultBecomesATapOfUnknownOutcomeOnce) {
  write_three(folder_.path() / "run", true);
  append(folder_.path() / "run" / "taps.jsonl", to_json_line(intent_row(tap(4, 0.0))) + "\n");
  for (int i = 0; i < 2; ++i) {
    RunDirectory run(folder_.path() / "run");
    const std::vector<PastTap> past = run.recover();
    ASSERT_EQ(past.size(), 4U);
    EXPECT_EQ(past[3].contact.outcome, Outcome::unknown);
    EXPECT_EQ(past[3].target.x, 0.4);
  }
}

/// Every way of writing there, each refused with `words`.
void expect_nothing_is_written(RunDirectory& run, const std::string& words) {
  using testing::StartsWith;
  const auto words_of = [](const auto& write) { return error_of(write, Error::Kind::run); };
  EXPECT_THAT(words_of([&] { run.announce(tap(2, 0.09)); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.record(tap(2, 0.09), kSeconds); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write("summary.json", std::string("{}")); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write_manifest(Tree::map()); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.write_objects({Row()}); }), StartsWith(words));
  EXPECT_THAT(words_of([&] { run.files().add_attempt(Row()); }), StartsWith(words));
}

TEST_F(RunFolder, IsWrittenToByNobodyWhoseLockWasRemovedOrTakenOver) {
  const fs::path folder = folder_.path() / "run";
  const fs::path lock = folder / "lock";
  RunDirectory run(folder);
  run.open(true);
  run.announce(tap(1, 0.09));
  run.record(tap(1, 0.09), kSeconds);
  const std::string recorded = text_of(folder / "taps.jsonl");
  fs::remove(lock);
  expect_nothing_is_written(run, lock.string() + ": was removed while a run was writing beside it");
  {
    RunDirectory other(folder);
    EXPECT_EQ(other.recover().size(), 1U);
    expect_nothing_is_written(run, lock.string() + ": was removed while a run was writing beside it");
  }
  EXPECT_EQ(text_of(folder / "taps.jsonl"), recorded);
  EXPECT_FALSE(fs::exists(folder / "summary.json"));
}

TEST_F(RunFolder, TakesTheResultOfATapWhereverItsFolderWasMovedMeanwhile) {
  RunDirectory run(folder_.path() / "run");
  run.open(true);
  run.announce(tap(1, 0.09));
  fs::rename(folder_.path() / "run", folder_.path() / "moved");
  run.record(tap(1, 0.09), kSeconds);
  EXPECT_EQ(RunFiles(folder_.path() / "moved").taps().size(), 2U);
  EXPECT_THAT(error_of([&] { run.announce(tap(2, 0.09)); }, Error::Kind::run),
              testing::HasSubstr("was moved or removed while a run was writing there"));
}

TEST_F(RunFolder, IsWrittenToByNoForkedChildAndFreeAgainThoughThatLives) {
  const fs::path folder = folder_.path() / "run";
  auto run = std::make_unique<RunDirectory>(folder);
  run->open(true);
  run->announce(tap(1, 0.09));
  run->record(tap(1, 0.09), kSeconds);
  const std::string recorded = text_of(folder / "taps.jsonl");
  const auto child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    expect_nothing_is_written(*run, folder.string() + ": is held by the process that this one was forked from");
    say(testing::Test::HasFailure() ? "written" : "refused");
    return ::pause();
  });
  while (child->said().empty() && !child->wait(0.001)) {
  }
  EXPECT_EQ(child->said(), "refused");
  EXPECT_EQ(text_of(folder / "taps.jsonl"), recorded);
  EXPECT_TRUE(is_running(folder));
  run.reset();
  EXPECT_FALSE(is_running(folder));
}

TEST_F(RunFolder, RefusesADamagedLineWithItsNumber) {
  write_three(folder_.path() / "run", false);
  std::string text = text_of(folder_.path() / "run" / "taps.jsonl");
  text[text.find('\n') + 5] = '\n';
  folder_.write("run/taps.jsonl", text);
  RunDirectory run(folder_.path() / "run");
  EXPECT_THAT(error_of([&] { run.recover(); }), testing::HasSubstr("taps.jsonl:2: is not a JSON object"));
}

TEST_F(RunFolder, RefusesALineThatIsNoTap) {
  folder_.write("run/taps.jsonl",
                "{\"tap\": 1, \"source\": \"initial\", \"x\": \"here\", \"y\": 0, \"outcome\": \"contact\"}\n");
  RunDirectory run(folder_.path() / "run");
  EXPECT_THROW(run.recover(), Error);
}

TEST_F(RunFolder, TellsItsStateFromItsFilesAlone) {
  const fs::path directory = folder_.path() / "run";
  EXPECT_EQ(read_status(directory).state, RunStatus::State::absent);
  write_three(directory, true);
  EXPECT_EQ(read_status(directory).state, RunStatus::State::unfinished);
  EXPECT_EQ(read_status(directory).taps, 3);
  {
    const RunDirectory held(directory);
    EXPECT_EQ(read_status(directory).state, RunStatus::State::running);
  }
  folder_.write("run/summary.json", "{\"status\": \"failed\", \"stop_reason\": \"the arm was stopped\"}");
  EXPECT_EQ(read_status(directory).state, RunStatus::State::failed);
  EXPECT_EQ(read_status(directory).stop_reason, "the arm was stopped");
  folder_.write("run/summary.json", "{\"status\": \"done\", \"stop_reason\": \"tap budget\"}");
  EXPECT_EQ(read_status(directory).state, RunStatus::State::done);
}

TEST(TapRow, ReadsBackAsTheTapThatItTells) {
  TapRecord record = tap(5, 0.1 + 0.2);
  record.source = Source::fallback;
  record.why = "no score is positive";
  const Row row = *parse_json_row(to_json_line(tap_row(record)));
  const PastTap back = past_taps({row}, "here").front();
  EXPECT_EQ(back.source, Source::fallback);
  EXPECT_EQ(back.target.x, record.target.x);
  EXPECT_EQ(back.contact.height, 0.1 + 0.2) << "to the last bit";
}

TEST(TapRow, AnIntentHoldsNoResult) {
  const Row row = intent_row(tap(1, 0.0));
  EXPECT_TRUE(is_intent(row));
  EXPECT_FALSE(is_intent(unknown_result_of(row)));
  EXPECT_EQ(*unknown_result_of(row).find("outcome"), Scalar{std::string("unknown")});
}

}  // namespace
}  // namespace palpate::test
