// SPDX-License-Identifier: MIT
// The importance of keys: known shares, the definition of the variance without noise, what must not matter, how often
// intervals contain the truth, and the approximation where settings are missing.
#include "analysis/importance.hpp"

#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using Texts = std::vector<std::string>;
using Places = std::vector<std::size_t>;
/// The metric at the places of the values, without seeds; the last place is that of the seed.
using Metric = std::function<double(const Places&)>;

/// A made-up sweep over all combinations of the values of some keys and of seeds; the last key varies fastest.
struct Grid {
  Sweep sweep{"runs/x/0123456789ab", {}, {}};
  std::vector<Row> results;

  Grid(Texts keys, const std::vector<Texts>& values, std::size_t seeds, const Metric& metric) {
    sweep.keys = std::move(keys);
    sweep.keys.emplace_back("seed");
    Places at(values.size() + 1, 0);
    const auto count = [&](std::size_t key) { return key < values.size() ? values[key].size() : seeds; };
    for (std::size_t key = 0; key < at.size();) {
      Texts words;
      for (std::size_t i = 0; i < values.size(); ++i) words.push_back(values[i][at[i]]);
      words.push_back(std::to_string(at.back()));
      add(words, metric(at));
      for (key = at.size(); key > 0 && ++at[key - 1] == count(key - 1); --key) at[key - 1] = 0;
      if (key == 0) break;
      key = 0;
    }
  }

  void add(const Texts& values, std::optional<double> value, const std::string& status = "done") {
    const int index = static_cast<int>(sweep.jobs.size());
    sweep.jobs.push_back({index, "id", values});
    Row row;
    row.add("job", index);
    for (std::size_t i = 0; i < values.size(); ++i) row.add(sweep.keys[i], values[i]);
    row.add("status", status);
    row.add("rmse_m", value);
    results.push_back(std::move(row));
  }

  /// Leaves out all jobs for which `is_out` of their values.
  void leave_out(const std::function<bool(const Texts&)>& is_out) {
    Grid rest = *this;
    rest.sweep.jobs.clear();
    rest.results.clear();
    for (std::size_t i = 0; i < sweep.jobs.size(); ++i) {
      if (!is_out(sweep.jobs[i].values)) rest.add(sweep.jobs[i].values, results[i].number("rmse_m"));
    }
    *this = rest;
  }

  Importance importance(const std::string& where = "") const {
    if (where.empty()) return compute_importance(sweep, results, "rmse_m");
    const WhereCondition condition(Tree::scalar(where, true));
    return compute_importance(sweep, results, "rmse_m", &condition);
  }
  std::string refusal(const std::string& where = "") const {
    return test::error_of([&] { importance(where); });
  }
};

const Row& row_of(const Importance& made, const std::string& keys) {
  for (const Row& row : made.table.rows()) {
    if (row.text("keys") == keys) return row;
  }
  throw std::runtime_error("no row " + keys);
}

double share_of(const Importance& made, const std::string& keys) { return row_of(made, keys).number("share").value(); }

double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(6.283185307179586 * random.uniform());
}

double variance_of(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double one : values) squares += std::pow(one - mean_of(values), 2);
  return squares / static_cast<double>(values.size());
}

const Texts kTwo{"kernel", "acquisition"};
const std::vector<Texts> kThreeByFour{{"rbf", "matern", "cubic"}, {"a", "b", "c", "d"}};
const std::vector<double> kOfKernel{-1.0, 0.5, 2.0};
const std::vector<double> kOfAcquisition{0.3, 0.1, -0.4, 0.7};

TEST(Importance, AnAdditiveTableHasTheVariancesOfItsTermsAndNoInteraction) {
  const Grid grid(kTwo, kThreeByFour, 6, [](const Places& at) {
    return 5.0 + kOfKernel[at[0]] + kOfAcquisition[at[1]] + std::pow(3.0, static_cast<double>(at[2]));
  });
  const Importance made = grid.importance();
  const double kernel = variance_of(kOfKernel);
  const double acquisition = variance_of(kOfAcquisition);
  EXPECT_NEAR(share_of(made, "kernel"), kernel / (kernel + acquisition), 1e-9);
  EXPECT_NEAR(share_of(made, "acquisition"), acquisition / (kernel + acquisition), 1e-9);
  EXPECT_NEAR(share_of(made, "kernel,acquisition"), 0.0, 1e-9);
  ASSERT_EQ(made.table.rows().size(), 3U) << "two keys have no interaction of three";
  EXPECT_EQ(made.table.rows()[0].text("keys"), "kernel") << "the most important key first";
  EXPECT_EQ(row_of(made, "kernel").flag("exact"), true);
  EXPECT_NEAR(*row_of(made, "kernel").number("noise"), 0.0, 1e-9) << "seeds only shift the table";
  EXPECT_THAT(made.text, HasSubstr("importance for rmse_m: share of the variance between 12 settings\n"));
  EXPECT_THAT(made.text, HasSubstr("exact: every combination of the values has run; 6 of 6 seeds used\n"));
}

TEST(Importance, APureInteractionBelongsToItsKeysTogether) {
  const std::vector<Texts> values{{"p", "q"}, {"r", "s"}, {"t", "u", "v"}};
  const auto sign = [](std::size_t at) { return at == 0 ? -1.0 : 1.0; };
  const Grid pair({"a", "b", "c"}, values, 5, [&](const Places& at) { return sign(at[0]) * sign(at[1]); });
  EXPECT_NEAR(share_of(pair.importance(), "a,b"), 1.0, 1e-9);
  EXPECT_NEAR(share_of(pair.importance(), "a"), 0.0, 1e-9);
  EXPECT_NEAR(share_of(pair.importance(), "c"), 0.0, 1e-9);
  const Grid three({"a", "b", "c"}, values, 5,
                   [&](const Places& at) { return sign(at[0]) * sign(at[1]) * (static_cast<double>(at[2]) - 1.0); });
  const Importance made = three.importance();
  EXPECT_NEAR(share_of(made, ""), 1.0, 1e-9);
  EXPECT_EQ(made.table.rows().size(), 7U);
  EXPECT_EQ(made.table.rows().back().text("keys"), "") << "last";
  EXPECT_THAT(made.text, HasSubstr("three or more        100.0 [100.0, 100.0]\n"));
}

/// Returns a table of two keys with noise whose size depends on the setting and the seed.
Metric noisy(std::uint64_t number, double size) {
  return [=](const Places& at) {
    Random random(number, "table", 100 * at[2] + 10 * at[1] + at[0]);
    Random of_seed(number, "seed", at[2]);
    const double slope = 1.0 + 0.5 * normal(of_seed);
    return 3.0 * normal(of_seed) + slope * kOfKernel[at[0]] + kOfAcquisition[at[1]] +
           0.3 * kOfKernel[at[0]] * kOfAcquisition[at[1]] + size * normal(random);
  };
}

TEST(Importance, AVarianceIsTheMeanProductOfEffectsOnTwoDifferentSeeds) {
  constexpr std::size_t kSeeds = 7;
  const Metric metric = noisy(3, 0.6);
  // The definition, loop by loop: effects of each seed as differences of means.
  const auto at = [&](std::size_t k, std::size_t a, std::size_t seed) { return metric({k, a, seed}); };
  std::vector<std::vector<double>> kernel(kSeeds, std::vector<double>(12, 0.0));
  std::vector<std::vector<double>> acquisition = kernel;
  std::vector<std::vector<double>> both = kernel;
  for (std::size_t seed = 0; seed < kSeeds; ++seed) {
    double all = 0.0;
    std::vector<double> of_k(3, 0.0);
    std::vector<double> of_a(4, 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t a = 0; a < 4; ++a) {
        all += at(k, a, seed) / 12.0;
        of_k[k] += at(k, a, seed) / 4.0;
        of_a[a] += at(k, a, seed) / 3.0;
      }
    }
    for (std::size_t i = 0; i < 12; ++i) {
      kernel[seed][i] = of_k[i / 4] - all;
      acquisition[seed][i] = of_a[i % 4] - all;
      both[seed][i] = at(i / 4, i % 4, seed) - of_k[i / 4] - of_a[i % 4] + all;
    }
  }
  const auto variance = [](const std::vector<std::vector<double>>& effects) {
    double sum = 0.0;
    for (std::size_t one = 0; one < kSeeds; ++one) {
      for (std::size_t other = 0; other < kSeeds; ++other) {
        for (std::size_t i = 0; i < 12 && one != other; ++i) sum += effects[one][i] * effects[other][i];
      }
    }
    return std::max(0.0, sum);
  };
  const double whole = variance(kernel) + variance(acquisition) + variance(both);
  const Importance made = Grid(kTwo, kThreeByFour, kSeeds, metric).importance();
  EXPECT_NEAR(share_of(made, "kernel"), variance(kernel) / whole, 1e-12);
  EXPECT_NEAR(share_of(made, "acquisition"), variance(acquisition) / whole, 1e-12);
  EXPECT_NEAR(share_of(made, "kernel,acquisition"), variance(both) / whole, 1e-12);
}

TEST(Importance, NamesOrderAndAConstantForEachSeedChangeNothing) {
  const Metric metric = noisy(4, 0.6);
  const Importance made = Grid(kTwo, kThreeByFour, 8, metric).importance();
  const auto same = [&](const Importance& other, const std::string& kernel, const std::string& acquisition,
                        const std::string& both) {
    for (const char* field : {"share", "low_95", "high_95", "noise"}) {
      EXPECT_NEAR(*row_of(made, "kernel").number(field), *row_of(other, kernel).number(field), 1e-9);
      EXPECT_NEAR(*row_of(made, "acquisition").number(field), *row_of(other, acquisition).number(field), 1e-9);
      EXPECT_NEAR(*row_of(made, "kernel,acquisition").number(field), *row_of(other, both).number(field), 1e-9);
    }
  };
  same(Grid({"x", "y"}, {{"3", "1", "2"}, {"5 cm", "1 mm", "2 m", "3 m"}}, 8, metric).importance(), "x", "y", "x,y");
  same(Grid({"acquisition", "kernel"}, {kThreeByFour[1], kThreeByFour[0]}, 8,
            [&](const Places& at) {
              return metric({at[1], at[0], at[2]});
            })
           .importance(),
       "kernel", "acquisition", "acquisition,kernel");
  same(Grid(kTwo, kThreeByFour, 8,
            [&](const Places& at) { return metric(at) + std::pow(7.0, static_cast<double>(at[2]) - 5.0); })
           .importance(),
       "kernel", "acquisition", "kernel,acquisition");
  Grid turned(kTwo, kThreeByFour, 8, metric);
  std::reverse(turned.sweep.jobs.begin(), turned.sweep.jobs.end());
  for (std::size_t i = 0; i < turned.sweep.jobs.size(); ++i) turned.sweep.jobs[i].index = static_cast<int>(i);
  std::reverse(turned.results.begin(), turned.results.end());
  for (std::size_t i = 0; i < turned.results.size(); ++i)
    turned.results[i].fields.front().second = static_cast<std::int64_t>(i);
  same(turned.importance(), "kernel", "acquisition", "kernel,acquisition");
}

TEST(Importance, SharesSumToOneAndLieInTheirIntervals) {
  for (std::uint64_t number = 0; number < 20; ++number) {
    const Grid grid({"a", "b", "c"}, {{"p", "q"}, {"r", "s", "t"}, {"u", "v"}}, 6, [&](const Places& at) {
      Random random(number, "table", 1000 * at[3] + 100 * at[2] + 10 * at[1] + at[0]);
      return static_cast<double>(at[1]) + 0.5 * normal(random);
    });
    const Importance made = grid.importance();
    double sum = 0.0;
    for (const Row& row : made.table.rows()) {
      sum += *row.number("share");
      EXPECT_GE(*row.number("low_95"), 0.0);
      EXPECT_LE(*row.number("low_95"), *row.number("share"));
      EXPECT_GE(*row.number("high_95"), *row.number("share"));
      EXPECT_LE(*row.number("high_95"), 1.0);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(Importance, IntervalsContainTheTruthInAtLeast88Of100Tables) {
  // The table of noisy() without noise and with the mean slope.
  const Importance truth =
      Grid(kTwo, kThreeByFour, 2, [](const Places& at) {
        return kOfKernel[at[0]] + kOfAcquisition[at[1]] + 0.3 * kOfKernel[at[0]] * kOfAcquisition[at[1]];
      }).importance();
  for (const std::size_t seeds : {5, 10, 20}) {
    std::map<std::string, int> hits;
    const int tables = test::brief() ? 100 : 1000;
    for (int number = 0; number < tables; ++number) {
      const Importance made =
          Grid(kTwo, kThreeByFour, seeds, noisy(static_cast<std::uint64_t>(number), 1.0)).importance();
      for (const Row& row : made.table.rows()) {
        const double share = share_of(truth, row.text("keys"));
        hits[row.text("keys")] += *row.number("low_95") <= share && share <= *row.number("high_95") ? 1 : 0;
      }
    }
    EXPECT_EQ(hits.size(), 3U);
    // With 1000 tables, these are 94 to 99 of 100.
    for (const auto& [keys, count] : hits) EXPECT_GE(count, 0.88 * tables) << keys << ", " << seeds << " seeds";
  }
}

TEST(Importance, NoiseAloneLeavesWideIntervalsOrNoShares) {
  int none = 0;
  double noise = 0.0;
  for (std::uint64_t number = 0; number < 100; ++number) {
    const Importance made = Grid(kTwo, kThreeByFour, 10, [&](const Places& at) {
                              Random random(number, "noise", 100 * at[2] + 10 * at[1] + at[0]);
                              return normal(random);
                            }).importance();
    const Row& first = made.table.rows().front();
    // The inverse of an F statistic with 11 and 99 degrees of freedom, whose mean is 11 / 9.
    noise += *first.number("noise") / 100.0;
    if (first.number("share")) {
      EXPECT_GT(*first.number("high_95") - *first.number("low_95"), 0.5);
    } else {
      ++none;
      EXPECT_GE(*first.number("noise"), 1.0);
      EXPECT_THAT(made.text, HasSubstr("\nno shares: the means of the settings differ by no more than the noise; run"));
    }
  }
  // Its standard deviation is 0.6, so that of the mean of 100 is 0.06.
  EXPECT_NEAR(noise, 11.0 / 9.0, 0.2);
  EXPECT_GT(none, 30);
  EXPECT_LT(none, 80);
  const Importance equal =
      Grid(kTwo, kThreeByFour, 5, [](const Places& at) { return 0.1 * static_cast<double>(at[2]); }).importance();
  EXPECT_FALSE(equal.table.rows().front().number("share"));
}

/// A smooth function of two quantities, one of them on a log scale, and of a choice.
Metric smooth(double noise) {
  return [=](const Places& at) {
    const double length = static_cast<double>(at[0]) / 5.0;
    const double taps = static_cast<double>(at[1]) / 3.0;
    Random random(1, "smooth", 1000 * at[3] + 100 * at[2] + 10 * at[1] + at[0]);
    return std::pow(length - 0.4, 2) * 4.0 + (at[2] == 0 ? 0.6 * taps : 0.2) + noise * normal(random) +
           static_cast<double>(at[3]);
  };
}
const Texts kThreeKeys{"kernel.length_scale", "taps", "acquisition"};
const std::vector<Texts> kSixByFourByTwo{
    {"5 mm", "1 cm", "2 cm", "4 cm", "8 cm", "0.16 m"}, {"10", "15", "20", "25"}, {"weighted", "uncertainty"}};

TEST(Importance, AGaussianProcessOverHalfOfTheSettingsHasTheExactSharesWithinATenth) {
  for (const double noise : {0.0, 0.1}) {
    const Grid all(kThreeKeys, kSixByFourByTwo, 4, smooth(noise));
    const Importance exact = all.importance();
    for (std::uint64_t number = 0; number < 10; ++number) {
      Random random(number, "half");
      std::set<Texts> out;
      while (out.size() < 24) {
        Texts setting = all.sweep.jobs[random.index(all.sweep.jobs.size())].values;
        setting.pop_back();
        out.insert(setting);
      }
      Grid half = all;
      half.leave_out([&](const Texts& values) { return out.count({values[0], values[1], values[2]}) > 0; });
      const Importance made = half.importance();
      EXPECT_EQ(made.table.rows().front().flag("exact"), false);
      double sum = 0.0;
      for (const Row& row : exact.table.rows()) {
        EXPECT_NEAR(share_of(made, row.text("keys")), *row.number("share"), 0.1) << number << ", " << row.text("keys");
        EXPECT_EQ(row_of(made, row.text("keys")).cell("low_95"), "");
        sum += share_of(made, row.text("keys"));
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_THAT(made.text, HasSubstr("\nkeys                             approximate share in %\n"));
      EXPECT_THAT(made.text,
                  HasSubstr("\napproximate, by a Gaussian process: not every combination of the values has "));
    }
  }
}

TEST(Importance, AGaussianProcessTakesQuantitiesInAnyUnitAndOnALogScale) {
  // A quarter of the settings is missing.
  const auto shares = [](const Texts& lengths) {
    std::vector<Texts> values = kSixByFourByTwo;
    values[0] = lengths;
    Grid grid(kThreeKeys, values, 4, smooth(0.2));
    grid.leave_out([&](const Texts& one) {
      return (one[0] == lengths[2] && one[2] == "weighted") || (one[0] == lengths[4] && one[1] != "10");
    });
    return grid.importance();
  };
  const Importance lengths = shares(kSixByFourByTwo[0]);
  // Lengths that are ten thousand times as large, and numbers that are as far apart as the logarithms of the lengths.
  const Importance longer = shares({"50 m", "100 m", "200 m", "400 m", "800 m", "1600 m"});
  const Importance logarithms = shares({"1", "2", "3", "4", "5", "6"});
  const Importance choices = shares({"a", "b", "c", "d", "e", "f"});
  for (const Row& row : lengths.table.rows()) {
    const double share = *row.number("share");
    EXPECT_NEAR(share_of(longer, row.text("keys")), share, 1e-9) << row.text("keys");
    EXPECT_NEAR(share_of(logarithms, row.text("keys")), share, 1e-9) << row.text("keys");
    EXPECT_NEAR(share_of(choices, row.text("keys")), share, 0.1) << row.text("keys");
  }
  EXPECT_GT(std::abs(share_of(choices, kThreeKeys[0]) - share_of(lengths, kThreeKeys[0])), 1e-4);
}

TEST(Importance, ARaceCountsWithTheSeedsOnWhichAllOfItsSettingsRan) {
  const Grid all(kThreeKeys, kSixByFourByTwo, 12, smooth(0.2));
  Grid race = all;
  // Of half of the settings, only the first four seeds; of one, none.
  race.leave_out([](const Texts& values) {
    return (values[1] > "15" && values[3] > "3" && values[3].size() == 1) ||
           (values[1] > "15" && values[3].size() == 2) || (values[0] == "2 cm" && values[1] == "25");
  });
  Grid four = race;
  four.leave_out([](const Texts& values) { return values[3] > "3" || values[3].size() == 2; });
  const Importance shares = four.importance();
  EXPECT_EQ(shares.table.rows().size(), 7U);
  for (const Row& row : shares.table.rows())
    EXPECT_EQ(share_of(race.importance(), row.text("keys")), *row.number("share"));
  EXPECT_THAT(race.importance().text, HasSubstr("; 4 of 12 seeds used\n"));
  // The first run of a new setting is left out until it has run on a second seed.
  race.add({"3 cm", "12", "weighted", "0"}, 7.0);
  EXPECT_EQ(share_of(race.importance(), "taps"), share_of(four.importance(), "taps"));
}

TEST(Importance, SeedsOnWhichASettingHasNoValueAreLeftOut) {
  const Metric metric = noisy(5, 0.6);
  const Importance seven = Grid(kTwo, kThreeByFour, 7, metric).importance();
  Grid eight(kTwo, kThreeByFour, 8, metric);
  eight.leave_out([](const Texts& values) { return values[0] == "rbf" && values[1] == "b" && values[2] == "7"; });
  eight.add({"rbf", "b", "7"}, std::nullopt);
  EXPECT_EQ(share_of(eight.importance(), "kernel"), share_of(seven, "kernel"));
  EXPECT_EQ(row_of(eight.importance(), "kernel").flag("exact"), true);
  EXPECT_THAT(eight.importance().text,
              HasSubstr("exact: every combination of the values has run; 7 of 8 seeds used\n"));
  eight.add({"cubic", "b", "6"}, 3.0, "failed");
  EXPECT_THAT(eight.importance().text, HasSubstr("7 of 8 seeds used\n")) << "a copy that failed";
  EXPECT_EQ(share_of(eight.importance("seed != 7"), "kernel"), share_of(seven, "kernel"));
  EXPECT_THAT(eight.importance("seed != 7").text, HasSubstr("7 of 7 seeds used\n"));
}

TEST(Importance, BelowFiveSeedsThereAreNoIntervals) {
  const Importance made = Grid(kTwo, kThreeByFour, 4, noisy(6, 0.6)).importance();
  EXPECT_EQ(row_of(made, "kernel").cell("low_95"), "");
  EXPECT_THAT(made.text, HasSubstr(" [-]\n"));
}

TEST(Importance, AConditionLeavesKeysWithOneValueOut) {
  const Grid grid({"a", "b", "c"}, {{"p", "q"}, {"r", "s"}, {"t", "u"}}, 5,
                  [](const Places& at) { return static_cast<double>(at[0] + 2 * at[1] * at[2]); });
  const Importance made = grid.importance("c == u");
  EXPECT_EQ(made.table.rows().size(), 3U);
  EXPECT_NEAR(share_of(made, "b"), 0.8, 1e-9);
}

TEST(Importance, RefusesInOneLineWhatCannotBeSplit) {
  EXPECT_EQ(Grid({"a"}, {{"p", "q"}}, 5, [](const Places&) { return 1.0; }).refusal(),
            "command line: --importance: fewer than two keys besides the seed vary, sweep another key");
  const Grid one_seed(kTwo, kThreeByFour, 1, noisy(1, 1.0));
  EXPECT_EQ(one_seed.refusal(),
            "command line: --importance: no two seeds have values in the same two settings, sweep the seed: "
            "seed=range(0,20)");
  EXPECT_EQ(Grid(kTwo, kThreeByFour, 5, noisy(1, 1.0)).refusal("seed == 3"), one_seed.refusal());
  EXPECT_THAT(Grid(kTwo, kThreeByFour, 5, noisy(1, 1.0)).refusal("seed == 9"), HasSubstr("--where: matches none of"));
  Grid apart(kTwo, kThreeByFour, 2, noisy(1, 1.0));
  apart.leave_out([](const Texts& values) { return (values[0] == "rbf") != (values[2] == "0"); });
  EXPECT_EQ(apart.refusal(), one_seed.refusal());
}

}  // namespace
}  // namespace palpate
