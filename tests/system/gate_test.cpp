// SPDX-License-Identifier: MIT
// `expect:` and `--junit` as continuous integration uses them: exit status, lines on stderr, files.
#include "config/yaml.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace palpate {
namespace {

/// A short experiment whose expectations begin at line 10.
std::string gate(const std::string& expect, const std::string& more = "") {
  return "name: gate\ndefaults:\n  - kernel: rbf\n  - acquisition: weighted\n  - fitting: fixed\n  - backend: "
         "simulator\n"
         "  - scene: object_i\ntaps: 8\nexpect:\n" +
         expect + "candidates: {count: 12}\n" + more;
}

/// What an XML reader that is not ours finds: a line a test case, "group|name|seconds >= 0|failure".
std::vector<std::string> junit_cases(const fs::path& file) {
  const std::string reader =
      "import sys, xml.etree.ElementTree as tree\n"
      "suites = tree.parse(sys.argv[1]).getroot()\n"
      "for suite in suites:\n"
      "    cases = suite.findall('testcase')\n"
      "    assert suites.tag == 'testsuites' and suite.tag == 'testsuite'\n"
      "    assert int(suite.get('tests')) == len(cases)\n"
      "    assert int(suite.get('failures')) == len(suite.findall('testcase/failure'))\n"
      "    for case in cases:\n"
      "        failure = case.find('failure')\n"
      "        print(case.get('classname'), case.get('name'), float(case.get('time')) >= 0,\n"
      "              '' if failure is None else failure.get('message'), sep='|')\n";
  const TemporaryFolder folder;
  const Ended ended = test::run_program({"/usr/bin/python3", "-c", reader, fs::absolute(file).string()}, folder.path(),
                                        {"PYTHONIOENCODING=utf-8"});
  EXPECT_EQ(ended.status, 0) << ended.err << text_of(file);
  std::vector<std::string> out(1);
  for (const char c : ended.out) {
    if (c == '\n') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  out.pop_back();
  return out;
}

TEST(Expect, WhatIsFulfilledIsCountedAndEndsWith0) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  found: true\n  rmse_m: <= 9 cm\n  mean(on_surface_taps): '>= 1'\n"));
  const Ended ended = test::palpate({"run", "gate.yaml"}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(ended.out, EndsWith("expected: 3 of 3\n"));
  const Ended json = test::palpate({"run", "gate.yaml", "--json"}, folder.path());
  EXPECT_EQ(json.status, 0);
  EXPECT_EQ(json.out, text_of(only_run(folder.path() / "runs") / "summary.json")) << "the summary and nothing else";
  const Ended quiet = test::palpate({"run", "gate.yaml", "--quiet"}, folder.path());
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST(Expect, WhatFailsIsALineWithItsPlaceAndEndsWith1) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  found: false\n  rmse_m: <= 9 cm\n  median(taps): '>= 12'\n"));
  for (const char* way : {"--quiet", "--json"}) {
    const Ended ended = test::palpate({"run", "gate.yaml", way}, folder.path());
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(ended.err,
              "gate.yaml:10:3: expected found == false, got true\n"
              "gate.yaml:12:3: expected median(taps) >= 12, got 8\n");
  }
}

TEST(Expect, OfARunThatIsDoneIsJudgedAgainByItsSummary) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  taps: == 8\n"));
  EXPECT_EQ(test::palpate({"run", "gate.yaml", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  const Ended tighter = test::palpate({"run", "gate.yaml", "--quiet", "expect.taps=> 8"}, folder.path());
  EXPECT_EQ(tighter.status, 1);
  EXPECT_EQ(tighter.err, "command line: expected taps > 8, got 8\n");
  EXPECT_EQ(only_run(folder.path() / "runs"), directory) << "what is expected does not enter the id";
  EXPECT_EQ(test::palpate({"resume", directory.string(), "--quiet"}, folder.path()).status, 0);
}

TEST(Expect, StaysInTheRecordedConfigSoThatItGatesAgain) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  taps: '>= 12'\n"));
  EXPECT_EQ(test::palpate({"run", "gate.yaml", "--quiet"}, folder.path()).status, 1);
  const fs::path directory = only_run(folder.path() / "runs");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", (directory / "config.yaml").string(), "--quiet"},
        std::vector<std::string>{"resume", directory.string(), "--quiet"}}) {
    const Ended ended = test::palpate(words, folder.path());
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("config.yaml:"));
    EXPECT_THAT(ended.err, HasSubstr(": expected taps >= 12, got 8\n"));
  }
}

TEST(Expect, OfARunThatWasBrokenOffIsJudgedWhenItIsCarriedOn) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  taps: '>= 12'\n"));
  EXPECT_EQ(test::palpate({"run", "gate.yaml", "--quiet"}, folder.path()).status, 1);
  const fs::path directory = only_run(folder.path() / "runs");
  fs::remove(directory / "summary.json");
  fs::resize_file(directory / "taps.jsonl", fs::file_size(directory / "taps.jsonl") / 2);
  const Ended ended = test::palpate({"resume", directory.string(), "--junit", "out.xml"}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("expected taps >= 12, got 8\n"));
  EXPECT_THAT(ended.out, EndsWith("expected: 0 of 1\n"));
  EXPECT_EQ(junit_cases(folder.path() / "out.xml").size(), 2U);
}

TEST(Expect, IsAGroupToo) {
  const TemporaryFolder folder;
  folder.write("configs/expect/strict.yaml", "expect:\n  taps: '>= 12'\n  rmse_m: <= 9 cm\n");
  std::string config = gate("");
  config.replace(config.find("expect:\n"), 8, "expect: strict\n");
  folder.write("gate.yaml", config);
  const Ended ended = test::palpate({"run", "gate.yaml", "--quiet"}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "configs/expect/strict.yaml:2:3: expected taps >= 12, got 8\n");
  EXPECT_EQ(test::palpate({"run", "gate.yaml", "--quiet", "expect.taps=<= 12"}, folder.path()).status, 0);
}

TEST(Expect, IsShownWithItsOrigins) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  rmse_m: <= 9 cm\n  compute.infer: < 1 s\n"));
  const Ended ended =
      test::palpate({"run", "gate.yaml", "expect.rmse_m=<= 1 cm", "--print-config", "--origins"}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("expect.rmse_m: \"<= 1 cm\" +# command line\n"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("expect.compute.infer: \"< 1 s\" +# gate.yaml:11:3\n"));
}

TEST(Expect, ThatIsBadIsRefusedBeforeAnythingMoves) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  rmse: <= 9 cm\n"));
  const std::string message = "gate.yaml:10:3: expect: the summary has no field 'rmse', did you mean 'rmse_m'?\n";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", "gate.yaml"}, std::vector<std::string>{"validate", "gate.yaml"},
        std::vector<std::string>{"sweep", "gate.yaml", "seed=1,2"}}) {
    const Ended ended = test::palpate(words, folder.path());
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.err, message);
    EXPECT_FALSE(fs::exists(folder.path() / "runs"));
  }
  const Ended swept = test::palpate({"sweep", paper(), "seed=1,2", "expect.taps=>1,>2"}, folder.path());
  EXPECT_EQ(swept.status, 2);
  EXPECT_EQ(swept.err, "command line: expect.taps: what is expected cannot be swept, give it one value\n");
}

TEST(Expect, OnASweepTakesStatisticsOverItsRuns) {
  const TemporaryFolder folder;
  folder.write("gate.yaml", gate("  failed_runs: == 0\n  mean(found): '>= 0.5'\n  median(taps): '> 8'\n",
                                 "sweep: {grid: {seed: \"range(0,6)\"}}\n"));
  const Ended ended = test::palpate({"sweep", "gate.yaml", "--quiet", "--junit", "out.xml"}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "gate.yaml:12:3: expected median(taps) > 8, got 8\n");
  EXPECT_THAT(ended.out, EndsWith("expected: 2 of 3\n"));
  const std::vector<std::string> cases = junit_cases(folder.path() / "out.xml");
  ASSERT_EQ(cases.size(), 6U + 3U);
  EXPECT_EQ(cases[2], "gate|job 2: seed=2|True|");
  EXPECT_EQ(cases[7], "gate.expect|mean(found) >= 0.5|True|");
  EXPECT_EQ(cases[8], "gate.expect|median(taps) > 8|True|gate.yaml:12:3: expected median(taps) > 8, got 8");

  const fs::path directory = only_run(folder.path() / "runs");
  const Ended resumed = test::palpate({"resume", directory.string(), "--quiet"}, folder.path());
  EXPECT_EQ(resumed.status, 1) << "carried on, it is judged again";
  EXPECT_THAT(resumed.err, EndsWith(": expected median(taps) > 8, got 8\n"));
  const Ended other =
      test::palpate({"sweep", "gate.yaml", "--quiet", "--runs", "other", "expect.median(taps)=== 8"}, folder.path());
  EXPECT_EQ(other.status, 0) << other.err;
  EXPECT_EQ(only_run(folder.path() / "other").filename(), directory.filename()) << "nor the id of a sweep";
}

TEST(Expect, CountsRunsThatFailAgainstASweep) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{
      "sweep",   paper(),  "scene.placement=random", "scene.objects.0.length=10cm,16cm,40cm", "--quiet",
      "--junit", "out.xml"};
  const auto with = [&](const std::string& runs, const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--runs", runs});
    all.insert(all.end(), more.begin(), more.end());
    return test::palpate(all, folder.path());
  };
  EXPECT_EQ(with("a", {}).status, 1) << "a run that fails makes a sweep fail";
  const std::vector<std::string> cases = junit_cases(folder.path() / "out.xml");
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_THAT(cases[2], HasSubstr("does not fit into the area"));
  EXPECT_EQ(with("b", {"expect.failed_runs=<= 1"}).status, 0) << "unless the config says how many may";
  EXPECT_EQ(with("c", {"expect.failed_runs=<= 1", "expect.median(taps)=== 17"}).status, 0);
  const Ended worst = with("d", {"expect.failed_runs=<= 1", "expect.max(rmse_m)=<= 9 m"});
  EXPECT_EQ(worst.status, 1);
  EXPECT_EQ(worst.err,
            "command line: expected max(rmse_m) <= 9 m, got no value: 1 of 3 runs have none and count as the worst "
            "(job 2: the run failed)\n");
}

TEST(JUnit, IsWrittenWithoutExpectations) {
  const TemporaryFolder folder;
  const Ended ended = test::palpate({"run", paper(), "--quiet", "--junit", "out.xml"}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  const std::vector<std::string> cases = junit_cases(folder.path() / "out.xml");
  ASSERT_EQ(cases.size(), 1U);
  EXPECT_THAT(cases[0], ::testing::MatchesRegex("object_i\\|run [0-9a-f]+\\|True\\|"));
}

TEST(JUnit, TakesAnyName) {
  const TemporaryFolder folder;
  const Ended ended =
      test::palpate({"run", paper(), "--quiet", "--junit", "out.xml", "name=<&\"\xef\xbf\xbe\xc3\xbc"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  // U+FFFE is UTF-8, and no character of XML.
  EXPECT_THAT(junit_cases(folder.path() / "out.xml").at(0), HasSubstr("<&\"\xef\xbf\xbd\xc3\xbc|"));
}

TEST(JUnit, TellsOfARunThatFailedAndOfWhatWasExpectedOfIt) {
  const TemporaryFolder folder;
  const Ended ended = test::palpate(
      {"run", paper(), "--quiet", "--junit", "out.xml", "expect.found=true", "acquisition=throws_in_score"},
      folder.path(), {"PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("throws_in_score").string()});
  EXPECT_EQ(ended.status, 1) << ended.err;
  const std::vector<std::string> cases = junit_cases(folder.path() / "out.xml");
  ASSERT_EQ(cases.size(), 2U);
  for (const std::string& one : cases) EXPECT_THAT(one, Not(EndsWith("|True|")));
}

TEST(JUnit, IsRefusedBeforeTheRunWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  for (const char* command : {"run", "sweep"}) {
    const Ended ended = test::palpate({command, paper(), "seed=3", "--junit", "no/such/out.xml"}, folder.path());
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.err, "no/such/out.xml: its folder does not exist, make it first\n");
    EXPECT_FALSE(fs::exists(folder.path() / "runs"));
  }
}

/// The gates that are shipped, and whether each is a sweep.
std::vector<std::pair<fs::path, bool>> gates() {
  std::vector<std::pair<fs::path, bool>> out;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "configs" / "ci")) {
    if (entry.path().extension() == ".yaml")
      out.emplace_back(entry.path(), read_yaml(entry.path()).find("sweep") != nullptr);
  }
  return out;
}

TEST(Gates, ThatAreShippedAreOpen) {
  const TemporaryFolder folder;
  for (const auto& [file, is_sweep] : gates()) {
    const Ended ended = test::palpate({is_sweep ? "sweep" : "run", file.string(), "--quiet"}, folder.path());
    EXPECT_EQ(ended.status, 0) << file << "\n" << ended.err;
  }
  EXPECT_GE(gates().size(), 4U);
}

/// An expectation that nothing fulfils, with the sign and the unit of `written`.
std::string tightened(const std::string& written) {
  if (written == "true") return "false";
  const auto number = written.find_first_of("0123456789");
  const auto unit = written.find_last_of("0123456789") + 1;
  const bool more = written[0] == '>';
  return written.substr(0, number) + (more ? "1e9" : "-1e9") + written.substr(unit);
}

TEST(Gates, ThatAreShippedCloseWhenAnyOfTheirBoundsIsTightened) {
  const TemporaryFolder folder;
  for (const auto& [file, is_sweep] : gates()) {
    const Tree config = read_yaml(file);
    std::vector<std::string> words{is_sweep ? "sweep" : "run", file.string(), "--quiet"};
    for (const Tree::Entry& entry : config.find("expect")->entries) {
      const Tree& first = entry.value.items.empty() ? entry.value : entry.value.items.front();
      words.push_back("expect." + entry.key + "=" + tightened(first.text));
    }
    const Ended ended = test::palpate(words, folder.path());
    EXPECT_EQ(ended.status, 1) << file << "\n" << ended.err;
    EXPECT_EQ(lines(ended.err), static_cast<int>(config.find("expect")->entries.size())) << ended.err;
  }
}

}  // namespace
}  // namespace palpate
