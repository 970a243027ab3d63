// SPDX-License-Identifier: MIT
// The paper's numbers, over a thousand starts, and what our policies make of its dead starts.
#include "record/row.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

namespace palpate {
namespace {

using test::TemporaryFolder;

using test::Cells;

/// How many of `all` starts are made here. What is counted comes out alike in every build, and a sanitizer sees in a
/// few starts what it would see in all.
int starts(int all, int sanitized) {
  if (!test::kSanitized) return all;
  std::cout << "the first " << sanitized << " of " << all << " starts: all take minutes here, release makes them\n";
  return sanitized;
}

std::string seeds(int count) { return "seed=range(0," + std::to_string(count) + ")"; }

/// The table of the only sweep that ran in `folder`.
std::vector<Cells> results_of(const TemporaryFolder& folder) {
  return test::csv_rows(test::text_of(test::only_run(folder.path() / "runs") / "results.csv"));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

TEST(Paper, ComparisonGivesTwelveTapsOnTheObjectForWeightedAndTwoForUncertainty) {
  const TemporaryFolder folder;
  const std::string config = (test::source_folder() / "configs/paper/comparison.yaml").string();
  const int count = starts(1000, 100);
  const test::Ended ended =
      test::palpate({"sweep", config, "acquisition=uncertainty,weighted", seeds(count), "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  std::map<std::string, std::vector<double>> live;
  std::map<std::string, int> runs;
  for (const Cells& row : results_of(folder)) {
    ++runs[row.at("acquisition")];
    const std::string hit = row.at("first_hit_tap");
    if (!hit.empty() && std::stoi(hit) <= 3)
      live[row.at("acquisition")].push_back(std::stod(row.at("on_surface_taps")));
    if (row.at("acquisition") == "weighted" && (hit.empty() || std::stoi(hit) > 3)) {
      EXPECT_EQ(row.at("on_surface_taps"), "0") << "without a fallback a dead start never recovers";
    }
  }
  for (const char* acquisition : {"uncertainty", "weighted"}) {
    EXPECT_EQ(runs[acquisition], count) << acquisition;
    const double share = static_cast<double>(live[acquisition].size()) / count;
    EXPECT_GE(share, 0.38);
    EXPECT_LE(share, 0.5) << "about half of all random starts are dead";
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
  double sum = 0.0;
  double squares = 0.0;
  for (const double one : differences) {
    sum += one;
    squares += one * one;
  }
  const double half = 1.96 * std::sqrt((squares / n - sum * sum / (n * n)) / (n - 1));
  return {sum / n, sum / n - half, sum / n + half};
}

TEST(Paper, FittedHyperparametersKnowBetterThanFixedOnesWhatTheyDoNotKnow) {
  const TemporaryFolder folder;
  const std::string config = (test::source_folder() / "configs/sweep/fitting.yaml").string();
  const int count = starts(100, 20);
  const test::Ended ended =
      test::palpate({"sweep", config, "surface=single", "taps=17", seeds(count), "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  std::map<std::string, std::map<std::string, Cells>> runs;  // by scene and seed, then by fitting
  for (const Cells& row : results_of(folder)) {
    runs[row.at("scene") + " " + row.at("seed")][row.at("fitting")] = row;
  }
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

TEST(Paper, TwoPartSurfaceKnowsTheHeightOfTheObjectToACentimetre) {
  const TemporaryFolder folder;
  const std::string config = (test::source_folder() / "configs/paper/object_i_right.yaml").string();
  const int count = starts(300, 60);
  const test::Ended ended =
      test::palpate({"sweep", config, "surface=two_part", seeds(count), "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  double sum = 0.0;
  int live = 0;
  for (const Cells& row : results_of(folder)) {
    const std::string hit = row.at("first_hit_tap");
    if (hit.empty() || std::stoi(hit) > 3) continue;
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
    Experiment experiment(config.options, test::shared_host(), nullptr);
    test::Collector collector;
    experiment.run(collector);
    std::vector<int> places;
    bool hit = false;
    for (const TapRecord& tap : collector.taps) {
      places.push_back(tap.candidate);
      hit = hit || *tap.on_surface;
    }
    std::sort(places.begin(), places.end());
    stalled += std::adjacent_find(places.begin(), places.end()) != places.end() ? 1 : 0;
    found += hit ? 1 : 0;
  }
  EXPECT_GE(found, 0.97 * count);
  EXPECT_EQ(stalled, 0);
  ::testing::Test::RecordProperty("found", found);
}

TEST(Paper, WithTheFallbackTheObjectOnTheRightIsFoundByTap17) { expect_found({}); }

TEST(Paper, WithTheFallbackTheObjectIsFoundByTap17AtRandomPlacement) { expect_found({"scene.placement=random"}); }

}  // namespace
}  // namespace palpate
