// SPDX-License-Identifier: MIT
#include "record/run_files.hpp"

#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "record/tap_row.hpp"
#include "support/parts.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace palpate::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHeader = "tap,robot,fit,infer,acquire,log\n";
constexpr std::array<double, kPhases> kTook{0.5, 0.0, 0.25, 0.125, 0.0625};

TapRecord made(int number) {
  TapRecord out;
  out.number = number;
  out.target = {0.1 * number, 0.05};
  out.contact = {Outcome::contact, 0.09, 8.0, 5.5, {}};
  out.on_surface = true;
  return out;
}

void make_taps(RunDirectory& run, int first, int last, bool announce = false) {
  run.open(announce);
  for (int i = first; i <= last; ++i) {
    run.announce(made(i));
    run.record(made(i), kTook);
  }
}

int count_lines(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

Row attempt(int number) {
  Row out;
  out.add("attempt", std::int64_t{number});
  return out;
}

class Files : public InFolder {
 protected:
  /// The folder of a job of a sweep, with nothing in it.
  fs::path job() const {
    folder_.write("sweep/manifest.jsonl", "");
    return make_folder(folder_.path() / "sweep" / "jobs" / "0123456789ab");
  }
  static std::vector<std::string> names_in(const fs::path& directory) {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(directory)) out.push_back(entry.path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(Files, TimingsAreReadUpToTheirEndOrTheirDamage) {
  EXPECT_TRUE(RunFiles(folder_.path()).timings().taps.empty()) << "no file";
  folder_.write("timings.csv", kHeader + std::string("1,0.5,0,0.25,0,0\n2,1,0,0,0,0.125\n3,1,0,0"));
  const Timings cut = RunFiles(folder_.path()).timings();
  ASSERT_EQ(cut.taps.size(), 2U) << "what has no line end was cut off by a kill";
  EXPECT_FALSE(cut.trouble);
  EXPECT_EQ(cut.taps[1].tap, 2);
  EXPECT_EQ(cut.taps[1].seconds, (std::array<double, kPhases>{1.0, 0.0, 0.0, 0.0, 0.125}));
  folder_.write("timings.csv", kHeader + std::string("1,,,,,\n2,1,0,0,0,0.125\n"));
  const Timings without = RunFiles(folder_.path()).timings();
  EXPECT_FALSE(without.trouble);
  ASSERT_EQ(without.taps.size(), 1U) << "of the other nothing is known";
  EXPECT_EQ(without.taps[0].tap, 2);
  for (const char* line : {"2,1,x,0,0,0", "2,,,,", "2,,,,,,", ",,,,,"}) {
    folder_.write("timings.csv", kHeader + std::string("1,0.5,0,0.25,0,0\n") + line + "\n3,1,0,0,0,0\n");
    const Timings damaged = RunFiles(folder_.path()).timings();
    EXPECT_EQ(damaged.taps.size(), 1U);
    ASSERT_TRUE(damaged.trouble);
    EXPECT_THAT(damaged.trouble->what(), HasSubstr("has the line '" + std::string(line) + "', the file is damaged"));
  }
}

TEST_F(Files, OfARunAreOneForEachPartAndOfAJobOneForAll) {
  const fs::path run = folder_.path() / "run";
  const Tree manifest = Tree::map({{"build", Tree::quote("a \"b\"\n")}, {"resumed", Tree::list()}});
  Row object;
  object.add("object", std::int64_t{0});
  object.add("type", std::string("cube"));
  for (const fs::path& directory : {run, job()}) {
    RunDirectory held(directory);
    held.files().add_attempt(attempt(1));
    held.write_manifest(Tree::map({{"build", Tree::quote("of before")}}));
    held.write_manifest(manifest);
    make_taps(held, 1, 3, true);
    held.write_objects({object});
  }
  EXPECT_THAT(names_in(run),
              ElementsAre("attempts.jsonl", "lock", "manifest.json", "objects.csv", "taps.jsonl", "timings.csv"));
  EXPECT_THAT(names_in(job()), ElementsAre("record.jsonl"));
  for (const char* name : {"taps.jsonl", "attempts.jsonl", "objects.csv"})
    EXPECT_EQ(part_of(job(), name), text_of(run / name));
  const RunFiles loose(run);
  const RunFiles packed(job());
  EXPECT_EQ(to_json(packed.manifest().value()), to_json(manifest));
  EXPECT_EQ(to_json(loose.manifest().value()), to_json(manifest));
  EXPECT_EQ(packed.attempts(), 1);
  const std::vector<Row> taps = packed.taps();
  ASSERT_EQ(taps.size(), 6U) << "announced and made";
  for (std::size_t i = 0; i < taps.size(); ++i) EXPECT_EQ(taps[i].fields, loose.taps()[i].fields) << i;
  ASSERT_EQ(packed.timings().taps.size(), 3U);
  EXPECT_EQ(packed.timings().taps[2].tap, 3);
  EXPECT_EQ(packed.timings().taps[2].seconds, kTook);
}

TEST_F(Files, OfAJobWithFilesForItsPartsStayThose) {
  for (const char* name : {"lock", "attempts.jsonl", "manifest.json", "taps.jsonl"}) {
    folder_.write("sweep/jobs/0123456789ab/" + std::string(name), "");
    EXPECT_EQ(taps_file_to_come(job()).filename(), "taps.jsonl") << name;
    fs::remove(job() / name);
  }
  for (const fs::path& directory : {job(), job() / ""})
    EXPECT_EQ(taps_file_to_come(directory).filename(), "record.jsonl") << "before it was begun";
  folder_.write("elsewhere/record.jsonl", "");
  EXPECT_EQ(taps_file_to_come(folder_.path() / "elsewhere").filename(), "record.jsonl") << "a job that was moved";
}

TEST_F(Files, OfAJobAreItsLockAndTellHowFarItIs) {
  EXPECT_EQ(read_status(job()).state, RunStatus::State::absent);
  {
    RunDirectory held(job());
    EXPECT_FALSE(is_running(folder_.path())) << "another one";
    EXPECT_TRUE(is_running(job()));
    EXPECT_THAT(error_of([&] { RunDirectory(this->job()); }), HasSubstr("another process holds this run"));
    EXPECT_EQ(read_record(job()).state, RunStatus::State::absent) << "locked, and nothing more";
    make_taps(held, 1, 2);
    EXPECT_EQ(read_status(job()).state, RunStatus::State::running);
  }
  EXPECT_FALSE(is_running(job()));
  EXPECT_EQ(read_status(job()).state, RunStatus::State::unfinished);
  EXPECT_EQ(read_status(job()).taps, 2);
}

TEST_F(Files, OfAJobThatAreCutAtAnyLengthHaveOfEachTapItsTimesToo) {
  RunDirectory(job()).files().add_attempt(attempt(1));
  {
    RunDirectory whole(job());
    whole.write_manifest(Tree::map({{"build", Tree::quote("b")}}));
    make_taps(whole, 1, 3);
  }
  const fs::path file = job() / "record.jsonl";
  const std::string whole = text_of(file);
  for (std::size_t cut = whole.size(); cut > 0; cut -= std::min<std::size_t>(cut, 7)) {
    std::ofstream(file) << whole.substr(0, cut);
    const int complete = count_lines(whole.substr(0, cut));
    RunDirectory held(job());
    held.files().add_attempt(attempt(2));
    EXPECT_EQ(held.recover().size(), static_cast<std::size_t>(std::max(0, complete - 2))) << cut;
    EXPECT_EQ(held.files().timings().taps.size(), held.rows().size()) << cut;
    EXPECT_EQ(held.files().attempts(), complete > 0 ? 2 : 1) << cut;
    EXPECT_EQ(held.files().manifest().has_value(), complete > 1) << cut;
    make_taps(held, static_cast<int>(held.rows().size()) + 1, 3);
    EXPECT_EQ(RunFiles(job()).taps().size(), 3U) << cut;
  }
}

TEST_F(Files, OfARunWhoseTimesWereCutGetALineForEachTapWhenItIsCarriedOn) {
  const fs::path directory = folder_.path() / "run";
  const fs::path times = directory / "timings.csv";
  {
    RunDirectory run(directory);
    make_taps(run, 1, 3);
  }
  const std::string whole = text_of(times);
  const std::vector<std::string> expected{"1,,,,,\n2,,,,,\n3,,,,,\n", "2,,,,,\n3,,,,,\n", "3,,,,,\n", ""};
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    fs::copy_file(directory / "taps.jsonl", folder_.path() / "taps", fs::copy_options::overwrite_existing);
    std::ofstream(times) << whole.substr(0, cut);
    const auto timed = static_cast<std::size_t>(std::max(0, count_lines(whole.substr(0, cut)) - 1));
    const std::string before = timed == 0 ? kHeader : whole.substr(0, whole.substr(0, cut).rfind('\n') + 1);
    for (int i = 0; i < 2; ++i) {
      RunDirectory run(directory);
      EXPECT_EQ(run.recover().size(), 3U);
      EXPECT_EQ(text_of(times), before + expected[timed]) << cut;
      EXPECT_DOUBLE_EQ(run.total_seconds()[0], 0.5 * static_cast<double>(timed));
    }
    RunDirectory run(directory);
    run.recover();
    make_taps(run, 4, 4);
    EXPECT_EQ(run.files().timings().taps.size(), timed + 1);
    EXPECT_EQ(count_lines(text_of(times)), 5);
    fs::rename(folder_.path() / "taps", directory / "taps.jsonl");
  }
}

TEST_F(Files, WhoseTapsDoNotCountUpAreRefusedByTheirLine) {
  const std::string hint = ", put the file back as it was, or begin anew with 'palpate run --force'";
  const auto refusal = [&](const std::string& lines) {
    const fs::path file = folder_.write("run/taps.jsonl", lines);
    const std::string said = error_of([&] { RunFiles(folder_.path() / "run").taps(); });
    return said == "accepted" ? said : said.substr(file.string().size());
  };
  const std::string one = "{\"tap\": 1}\n";
  const std::string two = "{\"tap\": 2}\n";
  const std::string intent = "{\"tap\": 2, \"intent\": true}\n";
  for (const std::string& sound : {one + two, one + intent + two, one + intent, one + intent + two + "{\"tap\": 4"})
    EXPECT_EQ(refusal(sound), "accepted") << sound;
  EXPECT_EQ(refusal(two), ":1: has tap 2 where tap 1 belongs: a line is missing" + hint);
  EXPECT_EQ(refusal(one + "{\"tap\": 3}\n" + two), ":2: has tap 3 where tap 2 belongs: a line is missing" + hint);
  EXPECT_EQ(refusal(one + one), ":2: has tap 1 a second time, where tap 2 belongs" + hint);
  EXPECT_EQ(refusal(one + intent + intent), ":3: announces tap 2 a second time" + hint);
  EXPECT_EQ(refusal(one + two + intent), ":3: announces tap 2, which is recorded already" + hint);
  EXPECT_EQ(refusal(intent), ":1: has tap 2 where tap 1 belongs: a line is missing" + hint);
  for (const char* number : {"\"2\"", "2.5", "null", "true", "-1", "0"})
    EXPECT_NE(refusal(one + "{\"tap\": " + number + "}\n"), "accepted") << number;
  EXPECT_EQ(refusal(one + "{\"x\": 1}\n"), ":2: has no number 'tap'" + hint);
}

TEST_F(Files, OfAJobThatAreDamagedAreRefusedByTheirLine) {
  folder_.write("job/record.jsonl", "{\"attempt\": 1}\n{\"manifest\": {\"a\": }}\n{\"tap\": 1\n{\"tap\": 2}\n");
  const RunFiles files(folder_.path() / "job");
  const std::string file = files.taps_file().string();
  EXPECT_EQ(error_of([&] { files.taps(); }), file + ":3: is not a JSON object, the file is damaged");
  EXPECT_THAT(error_of([&] { files.manifest(); }), HasSubstr(file + ":2:20: is not valid JSON"));
  EXPECT_EQ(files.attempts(), 1);
  for (const char* seconds : {"{}", "{\"robot\": 1, \"fit\": 1, \"infer\": 1, \"acquire\": 1}",
                              "{\"robot\": 1, \"fit\": 1, \"infer\": 1, \"acquire\": 1, \"log\": \"x\"}"}) {
    folder_.write("job/record.jsonl", fmt::format("{{\"tap\": 1, \"seconds\": {}, \"x\": 1}}\n", seconds));
    EXPECT_TRUE(files.timings().trouble) << seconds;
    EXPECT_EQ(files.taps().size(), 1U) << "no run depends on its times";
  }
}

}  // namespace
}  // namespace palpate::test
