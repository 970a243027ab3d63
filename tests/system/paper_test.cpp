// SPDX-License-Identifier: MIT
// The paper's numbers, over a thousand starts, and what our policies make of its starts without contact.
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <numeric>
#include <set>

namespace palpate {
namespace {

/// How many of `all` starts are made here.
int starts(int all, int few) {
  if (!test::brief()) return all;
  std::cout << "the first " << few << " of " << all << " starts: ./check --all makes all in release\n";
  return few;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

class Paper : public Shell {
 protected:
  /// The jobs of a sweep over so many starts.
  std::vector<Cells> results(const std::string& file, int starts, const Words& more) const {
    return csv_rows(
        text_of(swept(more + ("seed=range(0," + std::to_string(starts) + ")"), config(file)) / "results.csv"));
  }
  /// Whether one of the three initial taps hits the object.
  static bool is_live(const Cells& row) {
    const std::string hit = row.at("first_hit_tap");
    return !hit.empty() && std::stoi(hit) <= 3;
  }
};

TEST_F(Paper, ComparisonGivesTwelveTapsOnTheObjectForWeightedAndTwoForUncertainty) {
  const int count = starts(1000, 100);
  std::map<std::string, std::vector<double>> live;
  std::map<std::string, int> runs;
  for (const Cells& row : results("paper/comparison.yaml", count, "acquisition=uncertainty,weighted")) {
    ++runs[row.at("acquisition")];
    if (is_live(row)) {
      live[row.at("acquisition")].push_back(std::stod(row.at("object_taps")));
    } else if (row.at("acquisition") == "weighted") {
      EXPECT_EQ(row.at("object_taps"), "0") << "without a fallback a start without contact never recovers";
    }
  }
  for (const char* acquisition : {"uncertainty", "weighted"}) {
    EXPECT_EQ(runs[acquisition], count) << acquisition;
    const double share = static_cast<double>(live[acquisition].size()) / count;
    EXPECT_GE(share, 0.38);
    EXPECT_LE(share, 0.5) << "about half of all random starts are without contact";
  }
  EXPECT_EQ(median(live["weighted"]), 12.0);
  EXPECT_EQ(median(live["uncertainty"]), 2.0);
}

/// Mean and 95 % interval (normal approximation) of paired differences.
struct Interval {
  double mean, low, high;
};

Interval interval_of(const std::vector<double>& differences) {
  const auto n = static_cast<double>(differences.size());
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
  const double squares = std::inner_product(differences.begin(), differences.end(), differences.begin(), 0.0);
  const double half = 1.96 * std::sqrt((squares / n - sum * sum / (n * n)) / (n - 1));
  return {sum / n, sum / n - half, sum / n + half};
}

TEST_F(Paper, FittedHyperparametersKnowBetterThanFixedOnesWhatTheyDoNotKnow) {
  const int count = starts(100, 20);
  std::map<std::string, std::map<std::string, Cells>> runs;  // by scene and seed, then by fitting
  for (const Cells& row : results("sweep/fitting.yaml", count, "belief.surface=single taps=17"))
    runs[row.at("scene") + " " + row.at("seed")][row.at("fitting")] = row;
  for (const std::string scene : {"object_i ", "object_ii ", "object_i_right "}) {
    std::vector<double> nlpd;
    std::vector<double> rmse;
    for (auto& [key, pair] : runs) {
      if (key.compare(0, scene.size(), scene) != 0) continue;
      const auto difference = [&pair = pair](const char* field) {
        return std::stod(pair.at("ceres").at(field)) - std::stod(pair.at("fixed").at(field));
      };
      nlpd.push_back(difference("nlpd"));
      rmse.push_back(difference("rmse_m"));
    }
    ASSERT_EQ(nlpd.size(), static_cast<std::size_t>(count)) << scene;
    EXPECT_LT(interval_of(nlpd).high, 0.0) << scene;
    EXPECT_LT(interval_of(rmse).low, 0.0) << scene << "no worse surface for it";
  }
}

TEST_F(Paper, TwoPartSurfaceKnowsTheHeightOfTheObjectToACentimetre) {
  const int count = starts(300, 60);
  double sum = 0.0;
  int live = 0;
  for (const Cells& row : results("paper/object_i_right.yaml", count, "belief.surface=two_part")) {
    if (!is_live(row)) continue;
    sum += std::stod(row.at("rmse_height_m"));
    ++live;
  }
  ASSERT_GE(3 * live, count);
  EXPECT_LE(sum / live, 0.01);
}

/// Whether nearly all starts find the object within the budget, and none stalls.
void expect_found(const std::vector<std::string>& overrides) {
  ResolvedConfig config = test::shipped_config("paper/object_i_right.yaml", overrides);
  int found = 0;
  int stalled = 0;
  const int count = starts(1000, 100);
  for (int seed = 0; seed < count; ++seed) {
    config.options.seed = seed;
    Experiment experiment(config.options, {test::shared_host()});
    test::Collector collector;
    experiment.run(collector);
    std::set<int> places;
    bool hit = false;
    for (const TapRecord& tap : collector.taps) {
      places.insert(tap.candidate);
      hit = hit || tap.reading->on_object;
    }
    stalled += places.size() < collector.taps.size() ? 1 : 0;
    found += hit ? 1 : 0;
  }
  EXPECT_GE(found, 0.97 * count);
  EXPECT_EQ(stalled, 0);
  testing::Test::RecordProperty("found", found);
}

TEST_F(Paper, WithTheFallbackTheObjectOnTheRightIsFoundByTap17) { expect_found({}); }

TEST_F(Paper, WithTheFallbackTheObjectIsFoundByTap17AtRandomPlacement) { expect_found({"scene.placement=random"}); }

}  // namespace
}  // namespace palpate
