// SPDX-License-Identifier: MIT
// The groups and pairs of a comparison, its counts, and its text.
#include "support/made_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace palpate {
namespace {

using test::MadeJob;
using test::MadeSweep;
using ::testing::HasSubstr;
using ::testing::Not;

/// Returns jobs of two strategies with two kernels and `seeds` seeds. Strategy b is higher by 0.1 + seed / 1000 with
/// rbf, and by 0.2 with matern.
std::vector<MadeJob> two_by_two(int seeds) {
  std::vector<MadeJob> jobs;
  for (const char* kernel : {"rbf", "matern"}) {
    for (int seed = 0; seed < seeds; ++seed) {
      const double base = 0.1 + 0.01 * (seed * 7 % 5);
      const double gap = kernel == std::string("rbf") ? 0.1 + seed / 1000.0 : 0.2;
      jobs.push_back({"a", kernel, seed, base});
      jobs.push_back({"b", kernel, seed, base + gap});
    }
  }
  return jobs;
}

TEST(Compare, PairsJobsThatAreEqualInAllButTheKeyThatMakesTheGroups) {
  const Comparison made = MadeSweep(two_by_two(4)).by({"acquisition"});
  ASSERT_EQ(made.groups.size(), 2U);
  EXPECT_EQ(made.pairing, (std::vector<std::string>{"kernel", "seed"}));
  ASSERT_EQ(made.pairs.size(), 1U);
  EXPECT_EQ(made.groups[made.pairs[0].first].name, "b");
  EXPECT_EQ(made.groups[made.pairs[0].second].name, "a");
  EXPECT_EQ(made.pairs[0].difference.count, 8U);
  // 0.1 + (0 + 1 + 2 + 3) / 4000 with rbf, 0.2 with matern.
  EXPECT_NEAR(made.pairs[0].difference.mean, (0.1015 + 0.2) / 2.0, 1e-12);
  EXPECT_EQ(made.pairs[0].difference.clusters, 4U);
  EXPECT_EQ(made.pairs[0].test.higher, 4U) << "of the means per seed";
  EXPECT_NEAR(*made.pairs[0].test.p, 2.0 / 16.0, 1e-15);
  EXPECT_FALSE(made.pairs[0].p_holm) << "one pair needs no adjustment";
}

TEST(Compare, SortsGroupsByTheFirstKeyThenByTheSecondInTheOrderOfTheSweep) {
  const auto names = [](const std::vector<std::string>& by) {
    std::vector<std::string> out;
    for (const ComparedGroup& one : MadeSweep(two_by_two(2)).by(by).groups) out.push_back(one.name);
    return out;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({"kernel", "acquisition"}), (Names{"rbf, a", "rbf, b", "matern, a", "matern, b"}));
  EXPECT_EQ(names({"acquisition", "kernel"}), (Names{"a, rbf", "a, matern", "b, rbf", "b, matern"}));
}

TEST(Compare, NamesAGroupWhoseJobsLackAnOption) {
  const MadeSweep made({{"a", "", 1, 0.1}, {"b", "4", 1, 0.2}});
  const Comparison both = made.by({"acquisition", "kernel"}, "rmse_m", "a, (none)");
  EXPECT_EQ(both.groups[0].name, "a, (none)");
  EXPECT_EQ(both.groups[1].name, "b, 4");
  EXPECT_THAT(compare_tables(made.by({"kernel"})), HasSubstr("\n4 - (none) "));
}

TEST(Compare, CountsFailedUnfinishedAndValuelessJobsAndLeavesThemOutOfTheMean) {
  const Comparison made = MadeSweep({{"a", "k", 1, 0.1},
                                     {"a", "k", 2, 9.0, "failed"},
                                     {"a", "k", 3, 9.0, "absent"},
                                     {"a", "k", 4, {}},
                                     {"a", "k", 5, 0.3},
                                     {"b", "k", 1, 0.2},
                                     {"b", "k", 2, 0.2},
                                     {"b", "k", 3, 0.2},
                                     {"b", "k", 4, 0.2},
                                     {"b", "k", 6, 0.2}})
                              .by({"acquisition"});
  EXPECT_EQ(made.groups[0].counts.all(), 5);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::failed), 1);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::unfinished), 1);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::without_value), 1);
  EXPECT_EQ(made.groups[0].mean.count, 2U);
  EXPECT_DOUBLE_EQ(made.groups[0].mean.mean, 0.2);
  EXPECT_EQ(made.groups[1].mean.count, 5U);
  const ComparedPair& pair = made.pairs[0];
  EXPECT_EQ(pair.difference.count, 1U);
  EXPECT_EQ(pair.lost.of(ValueStatus::failed), 1);
  EXPECT_EQ(pair.lost.of(ValueStatus::unfinished), 1);
  EXPECT_EQ(pair.lost.of(ValueStatus::without_value), 1);
  EXPECT_EQ(pair.lost.of(ValueStatus::without_partner), 2) << "seeds 5 and 6";
  EXPECT_THAT(compare_tables(made),
              HasSubstr("b - a: pairs lost: 2 without a partner, 1 unfinished, 1 failed, 1 without a value\n"));
}

TEST(Compare, NeitherOrderOfJobsNorOfGroupsChangesWhatIsFound) {
  std::vector<MadeJob> jobs = two_by_two(20);
  const Comparison before = MadeSweep(jobs).by({"acquisition"});
  // Strategy b is now the first.
  std::reverse(jobs.begin(), jobs.end());
  const Comparison after = MadeSweep(jobs).by({"acquisition"});
  ASSERT_EQ(after.groups[0].name, "b");
  EXPECT_EQ(after.groups[0].mean.mean, before.groups[1].mean.mean);
  EXPECT_EQ(after.groups[0].mean.interval->low, before.groups[1].mean.interval->low);
  const ComparedPair& one = before.pairs[0];
  const ComparedPair& other = after.pairs[0];
  EXPECT_EQ(other.difference.mean, -one.difference.mean);
  EXPECT_EQ(other.difference.interval->low, -one.difference.interval->high);
  EXPECT_EQ(other.difference.interval->high, -one.difference.interval->low);
  EXPECT_EQ(*other.test.p, *one.test.p);
  EXPECT_EQ(*other.test.effect, -*one.test.effect);
}

TEST(Compare, WithABaselineComparesEveryGroupWithItAlone) {
  const Comparison made = MadeSweep(two_by_two(5)).by({"kernel", "acquisition"}, "rmse_m", "matern,a");
  EXPECT_TRUE(made.one_baseline);
  ASSERT_EQ(made.pairs.size(), 3U);
  for (const ComparedPair& pair : made.pairs) EXPECT_EQ(made.groups[pair.second].name, "matern, a");
  EXPECT_THAT(compare_tables(made), HasSubstr("4 groups: each is compared with matern, a only\n"));
  EXPECT_EQ(MadeSweep(two_by_two(5)).refusal({"acquisition"}, "rmse_m", "A"),
            "command line: --baseline: there is no group 'A', did you mean 'a'?");
}

TEST(Compare, ComparesGroupsOfOneSceneWithEachOtherAlone) {
  MadeSweep sweep(two_by_two(5));
  sweep.sweep.keys[1] = "scene";
  const auto names = [](const Comparison& made) {
    std::vector<std::string> out;
    for (const ComparedPair& pair : made.pairs)
      out.push_back(made.groups[pair.first].name + " - " + made.groups[pair.second].name);
    return out;
  };
  const Comparison made = sweep.by({"acquisition", "scene"});
  EXPECT_THAT(names(made), testing::ElementsAre("b, rbf - a, rbf", "b, matern - a, matern"));
  const std::vector<double> adjusted = holm_adjusted({*made.pairs[0].test.p, *made.pairs[1].test.p});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(*made.pairs[i].p_holm, adjusted[i]) << "for the pairs that there are";
  EXPECT_THAT(compare_tables(made), HasSubstr("4 groups: each is compared with the others of its scene\n"));
  EXPECT_THAT(names(sweep.by({"acquisition", "scene"}, "rmse_m", "b")),
              testing::ElementsAre("a, rbf - b, rbf", "a, matern - b, matern"));
  EXPECT_THAT(names(sweep.by({"acquisition", "scene"}, "rmse_m", "b, rbf")), testing::ElementsAre("a, rbf - b, rbf"));
  const Comparison of_rbf = sweep.by({"acquisition", "scene"}, "rmse_m", "b, rbf");
  EXPECT_THAT(compare_tables(of_rbf),
              HasSubstr("4 groups: each is compared with one of its scene\n2 groups are in no pair: "));
  const Comparison alone =
      sweep.by({"acquisition", "scene"}, "rmse_m", "b, rbf", "scene == matern or acquisition == b");
  EXPECT_THAT(alone.pairs, testing::IsEmpty());
  EXPECT_THAT(compare_tables(alone), HasSubstr("3 groups are in no pair: "));
  EXPECT_EQ(sweep.refusal({"acquisition", "scene"}, "rmse_m", "bb"),
            "command line: --baseline: there is no group 'bb', did you mean 'b'?");
  EXPECT_THAT(names(sweep.by({"scene"})), testing::ElementsAre("matern - rbf")) << "nothing else makes the groups";
}

TEST(Compare, OneGroupOrManyAreNotAllComparedWithEachOtherAndItSaysSo) {
  std::vector<MadeJob> jobs;
  for (int group = 0; group < 9; ++group) {
    for (int seed = 0; seed < 5; ++seed) jobs.push_back({"g" + std::to_string(group), "k", seed, 0.1 * group + seed});
  }
  const Comparison nine = MadeSweep(jobs).by({"acquisition"});
  EXPECT_EQ(nine.pairs.size(), 8U);
  EXPECT_THAT(compare_tables(nine), HasSubstr("9 groups: each is compared with g0 only\n"));
  jobs.resize(40);
  const Comparison eight = MadeSweep(jobs).by({"acquisition"});
  EXPECT_EQ(eight.pairs.size(), 28U);
  EXPECT_THAT(compare_tables(eight), Not(HasSubstr("each is compared")));
  jobs.resize(5);
  EXPECT_THAT(compare_tables(MadeSweep(jobs).by({"acquisition"})), HasSubstr("only one group: nothing to compare\n"));
}

TEST(Compare, SaysWhichKeyLeavesGroupsWithoutPairsAndWhatPairsThem) {
  // Strategy a lacks the option, and c shares one of its values with b.
  const MadeSweep made({{"a", "", 1, 0.1}, {"b", "3", 1, 0.2}, {"b", "4", 1, 0.3}, {"c", "4", 1, 0.4}});
  const Comparison apart = made.by({"acquisition"});
  EXPECT_EQ(apart.apart, std::vector<std::string>{"kernel"});
  EXPECT_THAT(compare_tables(apart),
              HasSubstr("\ngroups without a common kernel have no pairs: compare them with '--by acquisition,kernel'"));
  const Comparison paired = made.by({"acquisition", "kernel"});
  EXPECT_TRUE(paired.apart.empty());
  for (const ComparedPair& pair : paired.pairs) EXPECT_EQ(pair.difference.count, 1U);
  const Comparison seeds = MadeSweep({{"a", "k", 1, 0.1}, {"a", "k", 2, 0.2}, {"b", "k", 3, 0.3}}).by({"acquisition"});
  EXPECT_THAT(compare_tables(seeds),
              HasSubstr("\ngroups without a common seed have no pairs: run them on the same seeds\n"));
  EXPECT_THAT(compare_tables(seeds), Not(HasSubstr("--by"))) << "--by acquisition,seed is rejected";
  const MadeSweep shared({{"b", "3", 1, 0.2}, {"b", "4", 1, 0.3}, {"c", "4", 1, 0.4}});
  EXPECT_TRUE(shared.by({"acquisition"}).apart.empty()) << "one lost pair of two is no reason to group otherwise";
}

TEST(CompareWhere, LeavesJobsOutAndCountsThemAndThePairsThatItBreaks) {
  std::vector<MadeJob> jobs{{"a", "k", 1, 0.1}, {"a", "k", 2, 0.2}, {"a", "k", 3, 0.4}, {"a", "k", 4, {}, "failed"},
                            {"b", "k", 1, 0.1}, {"b", "k", 2, 0.4}, {"b", "k", 3, 0.4}, {"b", "k", 4, {}, "absent"}};
  const Comparison made = MadeSweep(jobs).by({"acquisition"}, "rmse_m", {}, "rmse_m <= 30 cm");
  EXPECT_EQ(made.left_out.all(), 5);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::left_out), 2);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::failed), 0);
  EXPECT_EQ(made.groups[1].counts.of(ValueStatus::left_out), 3);
  EXPECT_EQ(made.groups[1].mean.count, 1U);
  EXPECT_EQ(made.pairs[0].difference.count, 1U);
  EXPECT_EQ(made.pairs[0].lost.of(ValueStatus::left_out), 1) << "seed 2; seeds 3 and 4 are left out whole";
  EXPECT_EQ(made.pairs[0].lost.all(), 1);
  const std::string tables = compare_tables(made);
  EXPECT_THAT(tables, HasSubstr("--where excludes 5 of 8 jobs, of which 1 failed, 1 unfinished\n"));
  EXPECT_THAT(tables, HasSubstr("b - a: pairs lost: 1 with one job excluded by --where\n"));
}

TEST(CompareWhere, OnASweptKeyKnowsJobsThatHaveNotEnded) {
  const Comparison made =
      MadeSweep({{"a", "k", 1, 0.1}, {"a", "k", 2, 9.0, "absent"}, {"a", "m", 1, 0.3}, {"b", "k", 1, 0.2}})
          .by({"acquisition"}, "rmse_m", {}, "kernel == k");
  EXPECT_EQ(made.left_out.all(), 1);
  EXPECT_EQ(made.groups[0].counts.of(ValueStatus::unfinished), 1);
}

TEST(CompareWhere, AGroupThatItLeavesOutWholeIsCountedAndComparedWithNone) {
  const MadeSweep made(two_by_two(5));
  const Comparison three = made.by({"acquisition", "kernel"}, "rmse_m", {}, "acquisition != a or kernel != rbf");
  EXPECT_EQ(three.groups.size(), 4U);
  EXPECT_EQ(three.groups[0].counts.of(ValueStatus::left_out), 5);
  ASSERT_EQ(three.pairs.size(), 3U);
  for (const ComparedPair& pair : three.pairs) {
    EXPECT_NE(pair.second, 0U);
    EXPECT_EQ(pair.difference.count, 5U);
  }
  EXPECT_THAT(compare_tables(made.by({"acquisition"}, "rmse_m", {}, "acquisition == b")), HasSubstr("one group: "));
  EXPECT_EQ(made.refusal({"acquisition"}, "rmse_m", "a", "acquisition == b"),
            "command line: --baseline: --where excludes all jobs of 'a', name another group");
}

TEST(CompareWhere, RefusesUnknownNamesOtherUnitsAndWhatLeavesNothing) {
  const MadeSweep made(two_by_two(2));
  EXPECT_THAT(made.refusal({"acquisition"}, "rmse_m", {}, "rmse <= 1 m"), HasSubstr("did you mean 'rmse_m'?"));
  EXPECT_THAT(made.refusal({"acquisition"}, "rmse_m", {}, "rmse_m <= 1 s"), HasSubstr("compares a length"));
  EXPECT_EQ(made.refusal({"acquisition"}, "rmse_m", {}, "rmse_m > 1 m"),
            "command line: --where: matches none of the 8 jobs, check the values in results.csv, or in the files that "
            "--at or --until leave beside it");
  EXPECT_EQ(made.refusal({"acquisition"}, "rmse_m", {}, "found == true"), "accepted");
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  const MadeSweep made(two_by_two(2));
  EXPECT_EQ(made.refusal({"acquisitio"}),
            "command line: --by: this sweep does not vary 'acquisitio', did you mean 'acquisition'?");
  EXPECT_EQ(made.refusal({"taps"}), "command line: --by: this sweep does not vary 'taps', known: acquisition, kernel");
  EXPECT_EQ(made.refusal({"seed"}),
            "command line: --by: the seed repeats a job and cannot form groups, known: acquisition, kernel");
  EXPECT_EQ(made.refusal({"kernel", "kernel"}), "command line: --by: 'kernel' is named twice, name it once");
  EXPECT_EQ(made.refusal({"acquisition"}, "kernel"),
            "command line: --metric: 'kernel' is a swept key, not a result, use it with --by");
  EXPECT_EQ(made.refusal({"acquisition"}, "rmse"),
            "command line: --metric: results.csv has no column 'rmse', did you mean 'rmse_m'?");
  EXPECT_EQ(made.refusal({"acquisition"}, "status"),
            "command line: --metric: the column 'status' holds done, not numbers, name a column of numbers");
  EXPECT_EQ(
      made.refusal({"acquisition"}, "nlpd"),
      "command line: --metric: no job has a value of 'nlpd', no truth is known, or every cell on an object was tapped");
  EXPECT_EQ(MadeSweep({{"a", "k", 1, 0.1, "absent"}}).refusal({"acquisition"}),
            "runs/x/0123456789ab: no job of this sweep has ended, run it with 'palpate resume'");
  EXPECT_EQ(MadeSweep({{"a", "k", 1, 0.1, "failed"}}).refusal({"acquisition"}),
            "runs/x/0123456789ab: none of the jobs to compare ended well, see the reasons with 'palpate status'");
}

TEST(CompareTables, SayBetterOnlyWhereItIsKnown) {
  const MadeSweep made(two_by_two(3));
  const std::string less = compare_tables(made.by({"acquisition"}));
  EXPECT_THAT(less, HasSubstr("rmse_m [mm] by acquisition; less is better\n"));
  EXPECT_THAT(less, HasSubstr("better/equal/worse"));
  EXPECT_THAT(less, HasSubstr(" 0/0/3 "));
  const std::string more = compare_tables(made.by({"acquisition"}, "footprint_iou"));
  EXPECT_THAT(more, HasSubstr("footprint_iou by acquisition; more is better\n"));
  EXPECT_THAT(more, HasSubstr(" 0/0/3 "));
  const std::string neither = compare_tables(made.by({"acquisition"}, "coverage_95"));
  EXPECT_THAT(neither, HasSubstr("coverage_95 by acquisition\n"));
  EXPECT_THAT(neither, HasSubstr("higher/equal/lower"));
  EXPECT_THAT(neither, Not(HasSubstr("better")));
  EXPECT_THAT(neither, HasSubstr(" 0/3/0 "));
}

TEST(CompareTables, AreTheseLetterByLetter) {
  // 1.60: in R, s <- sd(0:5) / 2; s * qt(0.8, 5, 1.96) / (1.96 + qnorm(0.8)) * power.t.test(n = 6, power = 0.8, sd = 1,
  // type = "paired")$delta
  const std::string tables = compare_tables(MadeSweep(two_by_two(6)).by({"acquisition"}));
  EXPECT_EQ(
      tables,
      "rmse_m [mm] by acquisition; less is better\n"
      "acquisition  jobs   n  seeds  mean [95 % interval]  median  10 % to 90 %\n"
      "a              12  12      6        117 [100, 134]     115    100 to 139\n"
      "b              12  12      6        268 [251, 285]     271    206 to 329\n"
      "\n"
      "difference  pairs  lost  seeds        mean [95 % interval]  detectable  better/equal/worse      p  effect\n"
      "b - a          12     0      6  +151.25 [+150.27, +152.23]        1.60               0/0/6  0.031   +1.00\n"
      "\n"
      "only 6 seeds: an interval over so few (Student's t) can miss the true mean in more than 5 of 100 cases; "
      "run 10 or more\n");
}

TEST(CompareTables, NoteWhereTheMeanAndMostPairsDisagree) {
  std::vector<MadeJob> jobs;
  for (int seed = 0; seed < 10; ++seed) {
    jobs.push_back({"a", "k", seed, 0.2});
    jobs.push_back({"b", "k", seed, seed < 4 ? 5.0 + seed : 0.1});
  }
  const std::string tables = compare_tables(MadeSweep(jobs).by({"acquisition"}));
  EXPECT_THAT(tables, HasSubstr("b - a: worse on average, but better in most seeds: 6 of 10\n"));
}

TEST(CompareTables, KeepToTheWidthOfAScreenThoughNamesAreLong) {
  std::vector<MadeJob> jobs = two_by_two(6);
  for (MadeJob& job : jobs) job.strategy += "_with_the_longest_name";
  const Comparison made = MadeSweep(jobs).by({"acquisition", "kernel"});
  const std::string tables = compare_tables(made) + compare_legend({made});
  EXPECT_THAT(tables, HasSubstr("#  acquisition, kernel"));
  EXPECT_THAT(tables, HasSubstr("\n2 - 1 "));
  std::istringstream lines(tables);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120U) << line;
}

TEST(CompareTables, AreOneLineAJobWhateverIsInANames) {
  std::vector<MadeJob> jobs = two_by_two(2);
  for (MadeJob& job : jobs) job.strategy += "\n\x1b[2Jx";
  const std::string tables = compare_tables(MadeSweep(jobs).by({"acquisition"}));
  EXPECT_EQ(tables.find('\x1b'), std::string::npos);
  EXPECT_THAT(tables, HasSubstr("a  [2Jx"));
}

TEST(CompareRows, HoldTheNumbersOfGroupsAndPairsInSi) {
  const Comparison made = MadeSweep(two_by_two(6)).by({"acquisition"});
  const std::string csv = to_csv(compare_rows(made, "seed < 9"));
  EXPECT_THAT(csv, testing::StartsWith("kind,by,metric,where,planned,plan,group,"));
  const std::vector<Row> rows = compare_rows(made, "");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(*rows[0].find("group"), Scalar{std::string("a")});
  EXPECT_EQ(*rows[0].find("mean"), Scalar{made.groups[0].mean.mean});
  EXPECT_EQ(*rows[2].find("kind"), Scalar{std::string("pair")});
  EXPECT_EQ(*rows[2].find("low_95"), Scalar{made.pairs[0].difference.interval->low});
  EXPECT_EQ(*rows[2].find("p"), Scalar{*made.pairs[0].test.p});
  EXPECT_EQ(*rows[2].find("p_holm"), Scalar{});
}

}  // namespace
}  // namespace palpate
