// SPDX-License-Identifier: MIT
// `expect:` and `--junit` as continuous integration uses them: exit status, lines on stderr, files.
#include "config/yaml.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>

namespace palpate {
namespace {

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
  return lines_of(ended.out);
}

class Expect : public Shell {
 protected:
  /// Writes a short experiment whose expectations begin at line 10.
  void gate(const std::string& expect, const std::string& more = "") const {
    write("gate.yaml",
          "name: gate\ndefaults:\n  - kernel: rbf\n  - acquisition: weighted\n  - fitting: fixed\n"
          "  - backend: simulator\n  - scene: object_i\ntaps: 8\n" +
              expect + "candidates: {count: 12}\n" + more);
  }
  Ended run_gate(const Words& more = "--quiet") const { return run(more, "gate.yaml"); }
  fs::path out() const { return here() / "out.xml"; }
};

TEST_F(Expect, WhatIsFulfilledIsCountedAndEndsWith0) {
  gate("expect:\n  found: true\n  rmse_m: <= 9 cm\n  mean(object_taps): '>= 1'\n");
  const Ended ended = run_gate({});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(ended.out, EndsWith("expected: 3 of 3\n"));
  const Ended as_json = run_gate("--json");
  EXPECT_EQ(as_json.status, 0);
  EXPECT_EQ(as_json.out, text_of(directory() / "summary.json")) << "the summary and nothing else";
  const Ended quiet = run_gate();
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(Expect, WhatFailsIsALineWithItsPlaceAndEndsWith1) {
  gate("expect:\n  found: false\n  rmse_m: <= 9 cm\n  median(taps): '>= 12'\n");
  for (const char* way : {"--quiet", "--json"}) {
    const Ended ended = run_gate(way);
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(ended.err,
              "gate.yaml:10:3: expected found == false, got true\n"
              "gate.yaml:12:3: expected median(taps) >= 12, got 8\n");
  }
}

TEST_F(Expect, OfARunThatIsDoneIsJudgedAgainByItsSummary) {
  gate("expect:\n  taps: == 8\n");
  EXPECT_EQ(run_gate().status, 0);
  const fs::path before = directory();
  EXPECT_EQ(refused({"run", "gate.yaml", "--quiet", "expect.taps=> 8"}, 1), "command line: expected taps > 8, got 8\n");
  EXPECT_EQ(directory(), before) << "what is expected does not enter the id";
  EXPECT_EQ(resume(before).status, 0);
}

TEST_F(Expect, StaysInTheRecordedConfigSoThatItGatesAgainAlsoWhenARunIsCarriedOn) {
  gate("expect:\n  taps: '>= 12'\n");
  EXPECT_EQ(run_gate().status, 1);
  for (const Ended& ended : {run("--quiet", directory() / "config.yaml"), resume(directory())}) {
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("config.yaml:"), HasSubstr(": expected taps >= 12, got 8\n")));
  }
  break_off(directory());
  const Ended carried_on = palpate({"resume", directory(), "--junit", "out.xml"});
  EXPECT_EQ(carried_on.status, 1);
  EXPECT_THAT(carried_on.err, HasSubstr("expected taps >= 12, got 8\n"));
  EXPECT_THAT(carried_on.out, EndsWith("expected: 0 of 1\n"));
  EXPECT_EQ(junit_cases(out()).size(), 2U);
}

TEST_F(Expect, IsAGroupToo) {
  write("configs/expect/strict.yaml", "expect:\n  taps: '>= 12'\n  rmse_m: <= 9 cm\n");
  gate("expect: strict\n");
  EXPECT_EQ(refused({"run", "gate.yaml", "--quiet"}, 1),
            "configs/expect/strict.yaml:2:3: expected taps >= 12, got 8\n");
  EXPECT_EQ(run_gate({"--quiet", "expect.taps=<= 12"}).status, 0);
}

TEST_F(Expect, ThatIsBadIsRefusedBeforeAnythingMoves) {
  gate("expect:\n  rmse: <= 9 cm\n");
  for (const char* words : {"run gate.yaml", "validate gate.yaml", "sweep gate.yaml seed=1,2"}) {
    EXPECT_EQ(refused(words), "gate.yaml:10:3: expect: the summary has no field 'rmse', did you mean 'rmse_m'?\n");
  }
  EXPECT_EQ(refused({"sweep", paper(), "seed=1,2", "expect.taps=>1,>2"}),
            "command line: expect.taps: expectations cannot be swept, give it one value\n");
  EXPECT_TRUE(left_nothing());
}

TEST_F(Expect, OnASweepTakesStatisticsOverItsRuns) {
  gate("expect:\n  failed_runs: == 0\n  mean(found): '>= 0.5'\n  median(taps): '> 8'\n",
       "sweep: {grid: {seed: \"range(0,6)\"}}\n");
  const Ended ended = sweep("--quiet --junit out.xml", "gate.yaml");
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "gate.yaml:12:3: expected median(taps) > 8, got 8 over 6 seeds\n");
  EXPECT_THAT(ended.out, EndsWith("expected: 2 of 3\n"));
  const std::vector<std::string> cases = junit_cases(out());
  ASSERT_EQ(cases.size(), 6U + 3U);
  EXPECT_EQ(cases[2], "gate|job 2: seed=2|True|");
  EXPECT_EQ(cases[7], "gate.expect|mean(found) >= 0.5|True|");
  EXPECT_EQ(cases[8],
            "gate.expect|median(taps) > 8|True|gate.yaml:12:3: expected median(taps) > 8, got 8 over 6 seeds");

  const Ended resumed = resume(directory());
  EXPECT_EQ(resumed.status, 1) << "carried on, it is judged again";
  EXPECT_THAT(resumed.err, EndsWith(": expected median(taps) > 8, got 8 over 6 seeds\n"));
  EXPECT_EQ(swept({"--runs", "other", "expect.median(taps)=== 8"}, "gate.yaml").filename(), directory().filename())
      << "nor does it enter the id of a sweep";
}

TEST_F(Expect, CountsRunsThatFailAgainstASweep) {
  const auto with = [&](const Words& more) {
    return sweep(Words("scene.placement=random scene.objects.0.length=10cm,16cm,40cm --quiet --junit out.xml") + more);
  };
  EXPECT_EQ(with({}).status, 1) << "a run that fails makes a sweep fail";
  const std::vector<std::string> cases = junit_cases(out());
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_THAT(cases[2], HasSubstr("does not fit into the area"));
  const Words may_fail = {"--runs", "others", "expect.failed_runs=<= 1"};
  EXPECT_EQ(with(may_fail).status, 0) << "unless the config says how many may";
}

TEST_F(Expect, ASweepWithAnOpenJobFailsThoughFailedRunsAreExpected) {
  gate("expect:\n  failed_runs: <= 1\n", "sweep: {grid: {seed: [0, 1]}}\n");
  ASSERT_EQ(sweep("--quiet", "gate.yaml").status, 0);
  const fs::path table = fs::directory_iterator(directory() / "jobs")->path() / "taps.csv";
  fs::remove(table);
  fs::create_directory(table);  // where it cannot be written again
  const Ended ended = resume(directory());
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("resume with: palpate resume "));
}

using JUnit = Expect;

TEST_F(JUnit, IsWrittenWithoutExpectations) {
  ran("--junit out.xml");
  EXPECT_THAT(junit_cases(out()), ElementsAre(MatchesRegex("object_i\\|run [0-9a-f]+\\|True\\|")));
}

TEST_F(JUnit, TellsOfARunThatFailedAndOfWhatWasExpectedOfIt) {
  environment_ = {test::with_plugin("throws_in_score")};
  const Ended ended = run("--quiet --junit out.xml expect.found=true acquisition=throws_in_score");
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(junit_cases(out()), ElementsAre(Not(EndsWith("|True|")), Not(EndsWith("|True|"))));
}

TEST_F(JUnit, IsRefusedBeforeTheRunWhereItCannotBeWritten) {
  for (const char* command : {"run", "sweep"}) {
    EXPECT_EQ(refused({command, paper(), "seed=3", "--junit", "no/such/out.xml"}),
              "no/such/out.xml: its folder does not exist, create it first\n");
  }
  EXPECT_TRUE(left_nothing());
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

using Gates = Shell;

TEST_F(Gates, ThatAreShippedAreOpen) {
  for (const auto& [file, is_sweep] : gates()) {
    const Ended ended = palpate({is_sweep ? "sweep" : "run", file, "--quiet"});
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

TEST_F(Gates, ThatAreShippedCloseWhenAnyOfTheirBoundsIsTightened) {
  for (const auto& [file, is_sweep] : gates()) {
    const Tree config = read_yaml(file);
    Words words{is_sweep ? "sweep" : "run", file, "--quiet"};
    for (const Tree::Entry& entry : config.find("expect")->entries) {
      const Tree& first = entry.value.items.empty() ? entry.value : entry.value.items.front();
      words.push_back("expect." + entry.key + "=" + tightened(first.text));
    }
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 1) << file << "\n" << ended.err;
    EXPECT_EQ(lines(ended.err), static_cast<int>(config.find("expect")->entries.size())) << ended.err;
  }
}

/// The workflow that ci.md shows, in a repository of somebody's own: its steps in order, but what installs palpate.
class Workflow : public Shell {
 protected:
  Workflow() {
    const std::string page = text_of(test::source_folder() / "framework/docs/ci.md");
    const auto begin = page.find("```yaml\n# .github/workflows/");
    if (begin == std::string::npos) throw std::runtime_error("ci.md shows no workflow");
    write("workflow.yaml", page.substr(begin + 8, page.find("\n```\n", begin) - begin - 7));
    const Tree workflow = read_yaml(here() / "workflow.yaml");
    for (const Tree& step : workflow.find_path("jobs.gate.steps")->items) {
      const Tree* run = step.find("run");
      if (run != nullptr && run->text.find("apt-get") == std::string::npos) steps_.push_back(run->text);
    }
    fs::create_directories(here() / "bin");
    fs::create_symlink(test::program_file(), here() / "bin" / "palpate");
    for (const char* name : {"object_i.yaml", "strategy.yaml"}) write(gate(name), text_of(shipped("ci") / name));
  }
  static std::string gate(const std::string& name) { return "gates/" + name; }
  static fs::path shipped(const std::string& folder) { return test::source_folder() / "configs" / folder; }
  /// As the service runs a step without a shell of its own: by sh -e.
  Ended step(std::size_t which) const {
    const char* path = std::getenv("PATH");
    return test::run_program({"sh", "-e", "-c", steps_.at(which)}, here(),
                             {"PATH=" + (here() / "bin").string() + ":" + (path != nullptr ? path : "")});
  }
  void replace(const std::string& name, const std::string& what, const std::string& with) const {
    std::string text = text_of(here() / gate(name));
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos);
    write(gate(name), text.replace(at, what.size(), with));
  }

  std::vector<std::string> steps_;
};

TEST_F(Workflow, OfThePageHoldsConfigsOfOnesOwnToTheirWord) {
  ASSERT_EQ(steps_.size(), 3U);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Ended ended = step(i);
    EXPECT_EQ(ended.status, 0) << steps_[i] << ended.err;
    EXPECT_THAT(ended.out, testing::Not(HasSubstr("::error::")));
  }
  EXPECT_GT(junit_cases(here() / "object_i.xml").size(), 1U);
  EXPECT_GT(junit_cases(here() / "strategy.xml").size(), 20U);

  replace("object_i.yaml", "rmse_m: \"<= 3.6 cm\"", "rmse_m: \"<= 1 mm\"");
  replace("strategy.yaml", "mean(found): \">= 0.85\"", "mean(found): \">= 1\"");
  EXPECT_EQ(step(0).status, 0) << "what is expected is sound all the same";
  EXPECT_EQ(step(1).status, 1);
  const Ended broken = step(2);
  EXPECT_EQ(broken.status, 1);
  EXPECT_THAT(broken.out, HasSubstr("::error::an expectation does not hold"));

  replace("strategy.yaml", "taps: 17", "tap: 17");
  EXPECT_EQ(step(0).status, 2);
  const Ended wrong = step(2);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.out, HasSubstr("::error::the config or the call is wrong"));
}

}  // namespace
}  // namespace palpate
