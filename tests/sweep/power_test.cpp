// SPDX-License-Identifier: MIT
// Power of the paired t test and the seeds that it needs, compared with R, with published tables, and with t tests of
// simulated differences.
#include "support/clusters.hpp"
#include "support/made_sweep.hpp"

#include <fmt/format.h>

#include <functional>
#include <random>
#include <tuple>

namespace palpate {
namespace {

using test::each_alone;
using test::MadeJob;
using test::MadeSweep;
using ::testing::EndsWith;
using ::testing::HasSubstr;

using RandomStream = std::mt19937_64;
/// Draws a difference with mean 0 and standard deviation 1.
using DrawDifference = std::function<double(RandomStream&)>;

double gaussian(RandomStream& random) { return std::normal_distribution<>()(random); }
double skewed_up(RandomStream& random) { return std::exponential_distribution<>()(random) - 1.0; }
double skewed_down(RandomStream& random) { return -skewed_up(random); }

/// Plans of more units count with the power of this number, which is nearly 1.
constexpr std::size_t kMostUnits = 400;

/// Returns the power of the two-sided t test at 5 % for each number of units up to `most`, from 2000 simulated
/// samples that grow by one unit at a time. Its standard error is about 0.01.
std::vector<double> simulated_power(const DrawDifference& draw, double effect, std::size_t most = kMostUnits) {
  constexpr int kSamples = 2000;
  std::vector<double> critical(most + 1, 0.0);
  for (std::size_t units = 2; units <= most; ++units) critical[units] = student_factor(units - 1);
  std::vector<double> found(most + 1, 0.0);
  RandomStream random(1);
  for (int sample = 0; sample < kSamples; ++sample) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t units = 1; units <= most; ++units) {
      const double value = effect + draw(random);
      sum += value;
      squares += value * value;
      if (units == 1) continue;
      const auto n = static_cast<double>(units);
      const double variance = (squares - sum * sum / n) / (n - 1.0);
      if (std::abs(sum / n) > critical[units] * std::sqrt(variance / n)) found[units] += 1.0 / kSamples;
    }
  }
  return found;
}

/// Results of the plans from 200 simulated pilots.
struct PilotResults {
  double power = 0.0;           ///< average true power at the planned number of units
  double without_factor = 0.0;  ///< the same, planned by the standard deviation of the pilot without planning_sd()
  double coverage = 0.0;        ///< share of the pilots whose interval has the true standard deviation, which is 1
};

PilotResults results_of_pilots(const DrawDifference& draw, double effect, std::size_t seeds = 20) {
  constexpr int kPilots = 200;
  const std::vector<double> power = simulated_power(draw, effect);
  const auto power_of_plan = [&](double sd) { return power[std::min(units_needed(effect / sd, 0.8), kMostUnits)]; };
  PilotResults out;
  RandomStream random(2);
  for (int pilot = 0; pilot < kPilots; ++pilot) {
    std::vector<double> differences;
    while (differences.size() < seeds) differences.push_back(draw(random));
    const UnitSpread spread = spread_of_units(each_alone(differences)).value();
    out.power += power_of_plan(planning_sd(spread, 0.8)) / kPilots;
    out.without_factor += power_of_plan(spread.sd) / kPilots;
    if (spread.interval.low <= 1.0 && spread.interval.high >= 1.0) out.coverage += 1.0 / kPilots;
  }
  return out;
}

TEST(DetectableEffect, IsThatOfPowerTTestInR) {
  // power.t.test(n = units, power = power, sd = 1, type = "paired", tol = 1e-12)$delta
  const std::tuple<std::size_t, double, double> table[] = {
      {3, 0.8, 3.264043550},  {5, 0.8, 1.681997282},  {10, 0.8, 0.996002254},  {20, 0.8, 0.660442410},
      {20, 0.9, 0.764458022}, {50, 0.8, 0.404183492}, {100, 0.9, 0.327343197}, {1000, 0.8, 0.088679184}};
  for (const auto& [units, power, effect] : table) EXPECT_NEAR(detectable_effect(units, power), effect, 1e-8) << units;
}

TEST(DetectableEffect, IsFoundByThatShareOfSimulatedTTests) {
  for (const std::size_t units : {5U, 20U, 100U}) {
    // Three standard errors of a share of 2000.
    EXPECT_NEAR(simulated_power(gaussian, detectable_effect(units, 0.8), units)[units], 0.8, 0.027) << units;
    EXPECT_NEAR(simulated_power(gaussian, detectable_effect(units, 0.5), units)[units], 0.5, 0.034) << units;
  }
}

TEST(UnitsNeeded, AreThosePublishedForThePairedTTest) {
  // Cohen's small, medium and large effects; two-sided 5 %. G*Power (Faul et al. 2007) and power.t.test of R agree.
  const std::tuple<double, double, std::size_t> table[] = {{0.2, 0.8, 199}, {0.5, 0.8, 34}, {0.8, 0.8, 15},
                                                           {0.2, 0.9, 265}, {0.5, 0.9, 44}, {0.8, 0.9, 19}};
  for (const auto& [effect, power, units] : table) EXPECT_EQ(units_needed(effect, power), units) << effect;
}

TEST(UnitsNeeded, AreSixAtLeastAsTheSignedRankTestHasNoPBelowFivePercentForFewer) {
  EXPECT_EQ(units_needed(50.0, 0.8), 6U);
  const auto least_p = [](std::size_t units) {
    std::vector<double> ranks(units);
    for (std::size_t i = 0; i < units; ++i) ranks[i] = static_cast<double>(i + 1);
    return *signed_rank_test(ranks, std::vector<double>(units, 0.0)).p;
  };
  EXPECT_GT(least_p(5), 0.05);
  EXPECT_LT(least_p(6), 0.05);
}

TEST(UnitsNeeded, GrowWithTheInverseSquareOfASmallEffectAndEnd) {
  // (1.959964 + 0.841621)^2 = 7.848880 for a normal test.
  EXPECT_NEAR(static_cast<double>(units_needed(1e-4, 0.8)) / 7.848880e8, 1.0, 1e-6);
  EXPECT_EQ(units_needed(1e-9, 0.8), std::size_t{1} << 30) << "the largest number";
}

TEST(UnitSpread, OfTenSeedsHasTheChiSquareIntervalOfThePrintedTables) {
  // The chi-square distribution with 9 degrees of freedom exceeds 19.023 with 2.5 % and 2.700 with 97.5 %.
  const UnitSpread spread = spread_of_units(each_alone({1, 2, 3, 4, 5, 6, 7, 8, 9, 10})).value();
  EXPECT_NEAR(spread.sd * spread.sd, 82.5 / 9.0, 1e-12);
  EXPECT_NEAR(spread.degrees, 9.0, 1e-12) << "flatter than Gaussian";
  EXPECT_NEAR(spread.interval.low, std::sqrt(82.5 / 19.023), 1e-4);
  EXPECT_NEAR(spread.interval.high, std::sqrt(82.5 / 2.700), 1e-3);
}

TEST(UnitSpread, HasFewerDegreesOfFreedomIfOneSeedDecidesIt) {
  // One of n values differs from the others: the excess kurtosis is n. 2 / (2 / 4 + 5 / 5) = 4 / 3.
  EXPECT_NEAR(spread_of_units(each_alone({0, 0, 10, 0, 0}))->degrees, 4.0 / 3.0, 1e-12);
  // x <- 2^(0:6); 2 / (2 / 6 + e1071::kurtosis(x, type = 2) / 7)
  EXPECT_NEAR(spread_of_units(each_alone({1, 2, 4, 8, 16, 32, 64}))->degrees, 2.91938328881, 1e-9);
  EXPECT_NEAR(spread_of_units(each_alone({0, 0, 10}))->degrees, 2.0, 1e-12) << "too few for a kurtosis";
  EXPECT_NEAR(spread_of_units(each_alone({0, 1e200, 3e200, 0}))->degrees, 3.0, 1e-12) << "beyond the range of powers";
}

TEST(UnitSpread, IsMissingForOneUnitAndForEqualUnits) {
  EXPECT_FALSE(spread_of_units({}));
  EXPECT_FALSE(spread_of_units(each_alone({1.0})));
  EXPECT_FALSE(spread_of_units(each_alone({1.0, 1.0, 1.0})));
  EXPECT_FALSE(spread_of_units(each_alone({0.1, 0.2 - 0.1, 0.3 - 0.2}), 0.3)) << "equal but for rounding";
}

TEST(PlanningSd, IsTheFactorOfJuliousAndOwen) {
  // In R: z <- qnorm(0.975); qt(0.8, degrees, z) / (z + qnorm(0.8))
  const std::pair<double, double> table[] = {{2, 1.591330558}, {9, 1.100217316}, {19, 1.045701606}, {59, 1.014383702}};
  for (const auto& [degrees, factor] : table)
    EXPECT_NEAR(planning_sd({2.0, degrees, {}}, 0.8), 2.0 * factor, 1e-8) << degrees;
}

/// Returns the rest of a row of the table in docs/numerics.md.
std::string row_of(double effect, const PilotResults& results) {
  return fmt::format("{} sd | {:.1f} | {:.1f} | {:.1f} |", effect, 100.0 * results.power,
                     100.0 * results.without_factor, 100.0 * results.coverage);
}

std::string numerics_page() { return test::text_of(test::source_folder() / "framework/docs/numerics.md"); }

TEST(PlanFromAPilot, HasEightyPercentTruePowerOnAverageForGaussianDifferences) {
  for (const double effect : {0.25, 0.5}) {
    const PilotResults results = results_of_pilots(gaussian, effect);
    // Twice the standard error of an average over 200 pilots, whose powers vary by 0.1, and of the simulated power.
    EXPECT_NEAR(results.power, 0.8, 0.025) << effect;
    EXPECT_LT(results.without_factor, results.power - 0.02) << "a small pilot plans too few";
    EXPECT_GT(results.coverage, 0.91) << effect;
    EXPECT_THAT(numerics_page(), HasSubstr("| Gaussian | " + row_of(effect, results)));
  }
}

TEST(PlanFromAPilot, HasSeventyToNinetyPercentTruePowerForSkewedDifferences) {
  for (const double effect : {0.25, 0.5}) {
    for (const auto draw : {skewed_up, skewed_down}) {
      const PilotResults results = results_of_pilots(draw, effect);
      EXPECT_GT(results.power, 0.7) << effect;
      EXPECT_LT(results.power, 0.9) << effect;
      EXPECT_GT(results.coverage, 0.78) << effect << ": with 19 degrees of freedom it would be 0.72";
      const std::string name = draw == skewed_up ? "upwards" : "downwards";
      EXPECT_THAT(numerics_page(), HasSubstr("exponential, long tail " + name + " | " + row_of(effect, results)));
    }
  }
}

/// A sweep of two strategies whose differences per seed are these numbers, in millimetres.
std::vector<MadeJob> with_differences(const std::vector<double>& differences) {
  std::vector<MadeJob> jobs;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const int seed = static_cast<int>(i);
    jobs.push_back({"a", "k", seed, 0.010 + 0.001 * seed});
    jobs.push_back({"b", "k", seed, 0.010 + 0.001 * seed + 0.001 * differences[i]});
  }
  return jobs;
}

const std::vector<double> kTenSeeds{3, -1, 4, 1, -5, 9, 2, -6, 5, 3};

TEST(Power, ComparePrintsTheDetectableDifferenceAndStoresItInSiUnits) {
  const Comparison made = MadeSweep(with_differences(kTenSeeds)).by({"acquisition"});
  // In R, with d the differences: sd(d) * qt(0.8, 9, z) / (z + qnorm(0.8)) * power.t.test(n = 10, power = 0.8, ...)
  EXPECT_NEAR(compare_rows(made, "").back().number("detectable").value(), 0.00496153121287, 1e-9);
  EXPECT_THAT(compare_tables(made), HasSubstr("mean [95 % interval]  detectable  better/equal/worse"));
  EXPECT_THAT(compare_tables(made), HasSubstr("]         5.0               3/0/7  "));
  EXPECT_THAT(compare_legend({made}), HasSubstr("\ndetectable: true difference that a two-sided paired t test finds"));
  const Comparison equal = MadeSweep(with_differences(std::vector<double>(10, 1.0))).by({"acquisition"});
  EXPECT_EQ(compare_rows(equal, "").back().cell("detectable"), "");
}

TEST(Power, TheTableHasSeedsAndIntervalsOfR) {
  const Comparison made = MadeSweep(with_differences(kTenSeeds)).by({"acquisition"});
  EXPECT_EQ(power_table(made, 0.002, 0.8),
            "rmse_m [mm] by acquisition: seeds for a difference of 2 mm with 80 % power\n"
            "difference  pilot seeds  sd [95 % interval]  seeds needed [95 % interval]\n"
            "b - a                10      4.5 [3.1, 8.3]                  51 [22, 136]\n");
  EXPECT_THAT(power_table(made, 0.002, 0.9), EndsWith("  75 [28, 182]\n"));
}

TEST(Power, TheDetectableDifferenceOfAPilotNeedsAsManySeedsAsThePilotHas) {
  for (const std::size_t seeds : {6U, 10U, 20U, 57U}) {
    RandomStream random(seeds);
    std::vector<double> differences;
    while (differences.size() < seeds) differences.push_back(skewed_up(random));
    const Comparison made = MadeSweep(with_differences(differences)).by({"acquisition"});
    const double detectable = compare_rows(made, "").back().number("detectable").value();
    EXPECT_THAT(power_table(made, detectable * (1.0 + 1e-9), 0.8), HasSubstr(fmt::format(" {} [", seeds)));
    EXPECT_THAT(power_table(made, detectable * (1.0 - 1e-9), 0.8), HasSubstr(fmt::format(" {} [", seeds + 1)));
  }
}

TEST(Power, SeedsAreTheUnitsHoweverManyJobsTheyHave) {
  std::vector<MadeJob> jobs = with_differences(kTenSeeds);
  for (MadeJob job : std::vector<MadeJob>(jobs)) {
    job.kernel = "l";
    jobs.push_back(job);
  }
  EXPECT_EQ(power_table(MadeSweep(jobs).by({"acquisition"}), 0.002, 0.8),
            power_table(MadeSweep(with_differences(kTenSeeds)).by({"acquisition"}), 0.002, 0.8));
}

TEST(Power, PlansEachPairOrThePairsWithTheBaselineByTheirFullNames) {
  std::vector<MadeJob> jobs = with_differences(kTenSeeds);
  for (int seed = 0; seed < 10; ++seed)
    jobs.push_back({"a name that is longer than a column", "k", seed, 0.01 * (1 + seed * 7 % 5)});
  const MadeSweep sweep(jobs);
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_EQ(lines(power_table(sweep.by({"acquisition"}), 0.002, 0.8)), 2 + 3);
  const std::string table = power_table(sweep.by({"acquisition"}, "rmse_m", "a"), 0.002, 0.8);
  EXPECT_EQ(lines(table), 2 + 2);
  EXPECT_THAT(table, HasSubstr("\na name that is longer than a column - a "));
}

TEST(Power, RefusesPilotsThatShowNoSpread) {
  const auto refusal = [](const std::vector<double>& differences) {
    const Comparison made = MadeSweep(with_differences(differences)).by({"acquisition"});
    return test::error_of([&] { power_table(made, 0.002, 0.8); });
  };
  EXPECT_EQ(refusal({1.0, 2.0}), "b - a: fewer than 3 common seeds, run more; see 'palpate compare'");
  EXPECT_EQ(refusal({1.0, 2.0, 4.0}), "accepted");
  EXPECT_EQ(refusal({1.0, 1.0, 1.0, 1.0}),
            "b - a: the sd is 0, as all differences are equal, choose another metric or group");
  const Comparison alone = MadeSweep(with_differences({1, 2, 4})).by({"acquisition"}, "rmse_m", {}, "acquisition == a");
  EXPECT_EQ(test::error_of([&] { power_table(alone, 0.002, 0.8); }),
            "command line: --by: there is only one group, name another key");
}

}  // namespace
}  // namespace palpate
