// SPDX-License-Identifier: MIT
// What becomes of expectations: one run, many runs, runs that failed, runs without a value.
#include "record/gate.hpp"

#include "config/yaml.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

RunOutcome run(int job, std::optional<int> taps, std::optional<double> rmse, bool found = true) {
  Row row;
  row.add("status", "done");
  row.add("object_taps", taps);
  row.add("rmse_m", rmse);
  row.add("found", found);
  row.add("wall_seconds", 0.5);
  return {"job " + std::to_string(job) + ": seed=" + std::to_string(job), "job " + std::to_string(job), "", row};
}

RunOutcome failed(int job) {
  RunOutcome out = run(job, 99, 0.0);
  out.failure = "the arm is gone";
  return out;
}

/// The verdicts over runs on what stands behind `expect:`.
std::vector<ExpectationResult> verdicts(const std::string& expect, const std::vector<RunOutcome>& runs) {
  const Tree tree = parse_yaml("expect: " + expect + "\n", "c.yaml");
  return judge(read_expectations(tree.find("expect")), runs);
}

/// What each expectation got, and whether it holds: "yes 11", "no 3 in job 1".
std::vector<std::string> judged(const std::string& expect, const std::vector<RunOutcome>& runs) {
  std::vector<std::string> out;
  for (const ExpectationResult& one : verdicts(expect, runs)) out.push_back((one.holds ? "yes " : "no ") + one.got);
  return out;
}

using Texts = std::vector<std::string>;

TEST(Judge, ComparesASingleRunField) {
  const RunOutcome one = run(0, 11, 0.02);
  EXPECT_EQ(judged("{object_taps: '>= 11', rmse_m: <= 2 cm, found: true}", {one}),
            (Texts{"yes 11", "yes 2 cm", "yes true"}));
  EXPECT_EQ(judged("{object_taps: '> 11', rmse_m: < 20 mm, found: false, status: failed}", {one}),
            (Texts{"no 11", "no 20 mm", "no true", "no done"}));
}

TEST(Judge, TakesAStatisticOfASingleRunForItsValue) {
  const RunOutcome one = run(0, 11, 0.02);
  for (const char* name : {"mean", "median", "min", "max", "p10", "p95"})
    EXPECT_EQ(judged("{" + std::string(name) + "(object_taps): == 11}", {one}), (Texts{"yes 11"})) << name;
  EXPECT_EQ(judged("{mean(found): == 1}", {one}), (Texts{"yes 1"}));
}

TEST(Judge, ShowsAsManyDigitsAsItTakesToTellValueAndBoundApart) {
  EXPECT_EQ(judged("{rmse_m: <= 2 cm}", {run(0, 1, 0.0200001)}), (Texts{"no 2.00001 cm"}));
  EXPECT_EQ(judged("{rmse_m: <= 1.565 cm}", {run(0, 1, 1.5650845800732873e-2)}), (Texts{"no 1.5651 cm"}));
}

TEST(Judge, SaysWhyThereIsNoValue) {
  EXPECT_EQ(judged("{rmse_m: <= 2 cm}", {run(0, 1, {})}), (Texts{"no no value: no truth is known"}));
  EXPECT_EQ(judged("{median(rmse_m): <= 2 cm}", {run(0, 1, {})}), (Texts{"no no value: no truth is known"}));
  EXPECT_EQ(judged("{first_hit_tap: <= 3}", {run(0, 1, {})}), (Texts{"no no value: no object was found"}));
}

TEST(Judge, AValueThatIsNotFiniteFulfilsNothing) {
  for (const double value : {std::nan(""), -std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const char* bound : {"<= 2 cm", "< 2 cm", ">= 2 cm", "> 2 cm", "== 2 cm", "<= 1e300 m", ">= -1e300 m"}) {
      const std::string quoted = "'" + std::string(bound) + "'";
      EXPECT_EQ(judged("{rmse_m: " + quoted + "}", {run(0, 1, value)}), (Texts{"no no value: rmse_m is not finite"}))
          << value << bound;
      for (const char* statistic : {"mean", "max", "min", "median"}) {
        const std::string expect = "{" + std::string(statistic) + "(rmse_m): " + quoted + "}";
        EXPECT_EQ(judged(expect, {run(0, 1, value)}), (Texts{"no no value: rmse_m is not finite"})) << expect;
      }
    }
  }
}

TEST(Judge, ARunWhoseValueIsNotFiniteCountsAsTheWorst) {
  const std::vector<RunOutcome> runs{run(0, 2, 0.01), run(1, 4, std::nan("")), run(2, 9, 0.03)};
  const std::string why = ": 1 of 3 runs have no value and count as the worst (job 1: rmse_m is not finite)";
  EXPECT_EQ(judged("{mean(rmse_m): <= 1 m, max(rmse_m): <= 1 m, median(rmse_m): <= 2 cm}", runs),
            (Texts{"no no value" + why, "no no value" + why, "no 3 cm" + why}));
  EXPECT_EQ(judged("{median(rmse_m): <= 3 cm, min(rmse_m): == 1 cm}", runs), (Texts{"yes 3 cm", "no no value" + why}));
  EXPECT_EQ(judged("{rmse_m: <= 1 m}", runs), (Texts{"no no value: rmse_m is not finite in job 1"}));
}

TEST(Judge, SaysOverHowManySeedsAStatisticIs) {
  std::vector<RunOutcome> runs{run(0, 2, 0.01), run(1, 4, 0.02), run(2, 9, 0.03), run(3, 9, 0.03)};
  for (std::size_t i = 0; i < 4; ++i) runs[i].seed = i % 2 == 0 ? "7" : "8";
  EXPECT_EQ(judged("{mean(object_taps): '>= 7'}", runs), (Texts{"no 6 over 2 seeds"}));
}

TEST(Judge, AFieldAloneHasToHoldInEveryRun) {
  const std::vector<RunOutcome> runs{run(0, 11, 0.01), run(1, 3, 0.01), run(2, 5, 0.01), failed(3)};
  EXPECT_EQ(judged("{object_taps: '>= 3'}", {runs[0], runs[1]}), (Texts{"yes "}));
  EXPECT_EQ(judged("{object_taps: '>= 5'}", {runs[0], runs[1], runs[2]}), (Texts{"no 3 in job 1"}));
  EXPECT_EQ(judged("{object_taps: '>= 10'}", runs), (Texts{"no 3 in job 1, and 3 of 4 runs miss the expectation"}));
  EXPECT_EQ(judged("{rmse_m: <= 2 cm}", runs), (Texts{"no no value: the run failed in job 3"}));
}

TEST(Judge, TakesStatisticsOverAllRuns) {
  const std::vector<RunOutcome> runs{run(0, 2, 0.01), run(1, 4, 0.02), run(2, 9, 0.03)};
  EXPECT_EQ(judged("{median(object_taps): '>= 4', mean(object_taps): == 5, max(object_taps): < 9}", runs),
            (Texts{"yes 4", "yes 5", "no 9"}));
  EXPECT_EQ(judged("{p25(rmse_m): <= 15 mm}", runs), (Texts{"yes 15 mm"}));
}

TEST(Judge, ARunThatFailedTakesTheWorstValueWhicheverWayItIs) {
  const std::vector<RunOutcome> runs{run(0, 2, 0.01), run(1, 4, 0.02), run(2, 9, 0.03), failed(3), failed(4)};
  const std::string why = ": 2 of 5 runs have no value and count as the worst (job 3: the run failed)";
  EXPECT_EQ(judged("{median(object_taps): '>= 3', median(rmse_m): <= 2 cm}", runs),
            (Texts{"no 2" + why, "no 3 cm" + why}));
  EXPECT_EQ(judged("{mean(object_taps): '>= 0', max(rmse_m): <= 1 m, p90(rmse_m): < 1 m}", runs),
            (Texts{"no no value" + why, "no no value" + why, "no no value" + why}));
  EXPECT_EQ(judged("{median(object_taps): '>= 2', min(rmse_m): <= 1 cm}", runs), (Texts{"yes 2", "yes 1 cm"}));
}

TEST(Judge, AnEqualityHoldsWhereRunsThatFailedDoNotMatter) {
  const std::vector<RunOutcome> runs{run(0, 4, 0.01), run(1, 4, 0.02), run(2, 4, 0.03), failed(3)};
  EXPECT_EQ(judged("{median(object_taps): == 4}", runs), (Texts{"yes 4"}));
  EXPECT_EQ(judged("{min(object_taps): == 4}", runs)[0].substr(0, 2), "no");
  EXPECT_EQ(judged("{max(object_taps): == 4}", runs)[0].substr(0, 2), "no");
}

TEST(Judge, CountsRunsThatFailed) {
  EXPECT_EQ(judged("{failed_runs: == 0}", {run(0, 1, 0.1)}), (Texts{"yes 0"}));
  EXPECT_EQ(judged("{failed_runs: == 0}", {run(0, 1, 0.1), failed(1), failed(2)}), (Texts{"no 2 of 3"}));
  EXPECT_EQ(judged("{failed_runs: <= 2}", {run(0, 1, 0.1), failed(1), failed(2)}), (Texts{"yes 2 of 3"}));
}

TEST(VerdictLine, NamesPlaceKeyBoundAndWhatCame) {
  EXPECT_EQ(verdict_line(verdicts("\n  median(object_taps): '>= 12'", {run(0, 11, 0.1)}).at(0)),
            "c.yaml:2:3: expected median(object_taps) >= 12, got 11");
}

TEST(TestCases, AreOneARunAndOneAnExpectation) {
  const std::vector<RunOutcome> runs{run(0, 1, 0.1), failed(1)};
  const std::vector<TestCase> cases = test_cases("x", runs, verdicts("{failed_runs: == 0}", runs));
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_EQ(cases[0].name, "job 0: seed=0");
  EXPECT_EQ(cases[0].failure, "");
  EXPECT_EQ(cases[0].seconds, 0.5);
  EXPECT_EQ(cases[1].failure, "the arm is gone");
  EXPECT_EQ(cases[2].group, "x.expect");
  EXPECT_EQ(cases[2].failure, "c.yaml:1:10: expected failed_runs == 0, got 1 of 2");
}

TEST(TestCases, TellFailuresThatAreFewEnoughWithoutCountingThem) {
  const std::vector<RunOutcome> runs{run(0, 1, 0.1), failed(1)};
  const std::vector<TestCase> cases = test_cases("x", runs, verdicts("{failed_runs: <= 1}", runs));
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_TRUE(cases[1].tolerated);
  const std::string xml = junit_xml("x", cases);
  EXPECT_NE(xml.find("failures=\"0\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("skipped=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("<skipped message=\"the arm is gone\"/>"), std::string::npos) << xml;
}

TEST(JUnit, IsOneSuiteWithItsCountsAndItsTime) {
  EXPECT_EQ(junit_xml("x", {{"x", "job 0", 0.25, "", false}, {"x", "job 1", 0.5, "the arm is gone", false}}),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<testsuites tests=\"2\" failures=\"1\" errors=\"0\" time=\"0.750000\">\n"
            "  <testsuite name=\"x\" tests=\"2\" failures=\"1\" errors=\"0\" time=\"0.750000\" skipped=\"0\">\n"
            "    <testcase classname=\"x\" name=\"job 0\" time=\"0.250000\"/>\n"
            "    <testcase classname=\"x\" name=\"job 1\" time=\"0.500000\">\n"
            "      <failure message=\"the arm is gone\"/>\n"
            "    </testcase>\n"
            "  </testsuite>\n"
            "</testsuites>\n");
}

TEST(JUnit, EscapesMarksAndReplacesWhatXmlCannotHold) {
  const auto name_in = [](const std::string& name) {
    const std::string xml = junit_xml(name, {});
    const auto begin = xml.find("<testsuite name=\"") + 17;
    return xml.substr(begin, xml.find("\" tests", begin) - begin);
  };
  EXPECT_EQ(name_in("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
  EXPECT_EQ(name_in("a\nb\tc\r"), "a&#10;b&#9;c&#13;");
  EXPECT_EQ(name_in(std::string("a\0b\x1b", 4)),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd");
  EXPECT_EQ(name_in("\xc3\xbc"), "\xc3\xbc");
  EXPECT_EQ(name_in("\xff\xc3"), "\xef\xbf\xbd\xef\xbf\xbd") << "not UTF-8";
  for (const char* none : {"\xef\xbf\xbe", "\xef\xbf\xbf"})
    EXPECT_EQ(name_in(none), "\xef\xbf\xbd") << "U+FFFE, U+FFFF";
}

}  // namespace
}  // namespace palpate::test
