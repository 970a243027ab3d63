// SPDX-License-Identifier: MIT
// A record, a config or a sweep that somebody else has made may hold anything: what is no file, what leads elsewhere,
// what unfolds to gigabytes. Each command ends at once, in little memory, with one line that names the place.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <sys/stat.h>

namespace palpate {
namespace {

using testing::HasSubstr;

std::string many_times(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

class Received : public Shell {
 protected:
  /// The command with 2 GiB of addresses and a minute, after which it counts as one that never ends (status 124).
  Ended bounded(const Words& words) const {
    const std::string limit = test::kSanitized ? "" : "ulimit -v 2000000; ";
    Words all{"/bin/sh", "-c", limit + "exec timeout 60 \"$0\" \"$@\"", test::program_file().string()};
    return test::run_program(all + words, here(), environment_);
  }
  /// The one line with which it is refused.
  std::string refusal_of(const Words& words) const {
    const Ended ended = bounded(words);
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_LT(ended.err.size(), 2000U);
    return ended.err;
  }
  /// A finished run of six taps, copied anew.
  fs::path run_again() const {
    if (!fs::exists(here() / "made")) fs::rename(ran("taps=6"), here() / "made");
    fs::remove_all(here() / "run");
    fs::copy(here() / "made", here() / "run");
    return here() / "run";
  }
};

TEST_F(Received, ARecordWithAPipeOrADeviceInThePlaceOfAFileIsToldOfAtOnce) {
  for (const bool device : {false, true}) {
    for (const char* name : {"config.yaml", "record.jsonl"}) {
      const fs::path file = run_again() / name;
      fs::remove(file);
      if (device) {
        fs::create_symlink("/dev/zero", file);
      } else {
        ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
      }
      std::string all;
      for (const char* command : {"status", "report", "replay"}) {
        const Ended ended = bounded({command, here() / "run"});
        EXPECT_LE(ended.status, 2) << command << " " << file;
        EXPECT_LE(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
        all += ended.out + ended.err;
      }
      EXPECT_THAT(all, HasSubstr(std::string(name) + ": "));
      EXPECT_THAT(all, HasSubstr(device ? "is a symbolic link" : "not a regular file")) << file;
    }
  }
}

TEST_F(Received, ARecordDoesNotLeadToFilesOfItsReader) {
  const fs::path run = run_again();
  fs::rename(run / "config.yaml", here() / "private.yaml");
  fs::create_symlink(here() / "private.yaml", run / "config.yaml");
  EXPECT_THAT(refusal_of({"report", run}), HasSubstr("config.yaml: is a symbolic link"));
  EXPECT_FALSE(fs::exists(run / "report.html"));

  const fs::path sweep = swept("seed=1,2 taps=3");
  const fs::path job = job_of(sweep, 0);
  fs::rename(job, here() / "other");
  fs::create_directory_symlink(here() / "other", job);
  EXPECT_THAT(bounded({"list", sweep.parent_path(), "--json"}).out + bounded({"status", sweep}).out,
              HasSubstr("1 failed"));
}

TEST_F(Received, ARecordThatIsNestedDeeplyOrHoldsManyValuesTakesNoMemory) {
  const fs::path run = run_again();
  const std::string begun = test::begun_record();
  const auto said = [&](const std::string& line) {
    write(run / "record.jsonl", begun + line + "\n");
    EXPECT_THAT(bounded({"list", here(), "--json"}).err, HasSubstr("record.jsonl: its last line ")) << "by that alone";
    return refusal_of({"status", run});
  };
  const std::string end = "{\"end\": ";
  EXPECT_THAT(said(end + many_times("{\"a\":", 100'000) + "1" + many_times("}", 100'001)),
              HasSubstr("record.jsonl:4: is nested too deeply"));
  EXPECT_THAT(said(end + "1" + many_times(",\"a\":1", 190'000) + "}"), HasSubstr("record.jsonl:4: is too long"));
  EXPECT_THAT(said(end + "1" + many_times(",\"a\":1", 19'000) + "}"),
              HasSubstr("record.jsonl:4: contains too many values"));
  const std::string list = many_times("[", 100'000) + many_times("]", 100'000);
  for (const char* kind : {"objects", "setup", "weather"}) {
    write(run / "record.jsonl", begun + "{\"" + kind + "\": " + list + "}\n");
    EXPECT_THAT(refusal_of({"status", run}), HasSubstr("record.jsonl:4: is nested too deeply")) << kind;
  }
  write(run / "record.jsonl", "{\"manifest\": [" + many_times("1,", 2'000'000) + "1]}\n");
  EXPECT_THAT(refusal_of({"status", run}), HasSubstr("record.jsonl:1: contains too many values"));
}

TEST_F(Received, ADottedPathOfManyLevelsIsRefused) {
  const std::string path = many_times("a.", 60'000) + "a";
  EXPECT_THAT(refusal_of({"run", test::paper(), path + "=1"}), HasSubstr("is too long a path"));
}

TEST_F(Received, ASweepIsCountedBeforeItIsExpanded) {
  std::string list = "name: a\nsweep:\n  list:\n";
  for (int i = 0; i < 100; ++i) list += "  - {seed: 'range(0, 1000000)'}\n";
  EXPECT_THAT(refusal_of({"validate", write("list.yaml", list)}),
              HasSubstr("list.yaml:6:12: seed: the sweep names more than two million values, use fewer values"));
  std::string words = "seed=range(0,1000000)";
  for (int i = 0; i < 100; ++i) words += ",range(0,1000000)";
  EXPECT_THAT(refusal_of({"sweep", test::paper(), words}), HasSubstr("names more than two million values"));
}

TEST_F(Received, GroupsThatManyBuildOnAreComposedOnce) {
  const auto group = [&](int number, const std::string& text) {
    write("configs/kernel/g" + std::to_string(number) + ".yaml", text);
  };
  const auto next = [](int number) { return "  - kernel: g" + std::to_string(number + 1) + "\n"; };
  for (int i = 0; i < 12; ++i) group(i, "defaults:\n" + many_times(next(i), 4) + "kernel: {length_scale: 2 cm}\n");
  group(12, "kernel: {type: rbf}\n");
  const Words words{"run", test::paper(), "kernel=g0", "--print-config"};
  const Ended ended = bounded(words);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("length_scale: 0.02 m"));
  for (int i = 12; i < 20; ++i) group(i, "defaults:\n" + next(i) + "kernel: {}\n");
  EXPECT_THAT(refusal_of(words), HasSubstr("g15.yaml:2:13: groups are nested more than 16 levels deep"));
}

TEST_F(Received, TextThatIsPrintedMovesNoCursorAndTurnsNoLine) {
  const fs::path run = run_again();
  write(
      run / "record.jsonl",
      test::begun_record() + "{\"end\": \"failed\", \"reason\": \"a\\u001b[31mb\\u0007\\u009b2Jc\\u202ed \\u00e4\"}\n");
  EXPECT_THAT(bounded({"status", run}).out, EndsWith(": a\\x1b[31mb\\x07\\x9b2Jc\\u202ed \xc3\xa4\n"));
  EXPECT_THAT(refusal_of({"run", test::paper(), "na\xc2\x9bme=a"}), HasSubstr("'na\\x9bme'"));
}

}  // namespace
}  // namespace palpate
