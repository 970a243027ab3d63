// SPDX-License-Identifier: MIT
// The paper's numbers, over a thousand starts, and what our policies make of its dead starts.
#include "record/row.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

namespace palpate {
namespace {

using test::TemporaryFolder;

namespace fs = std::filesystem;

using Cells = std::map<std::string, std::string>;

std::vector<Cells> read_csv(const fs::path& file) {
  std::ifstream in(file);
  const auto split = [](const std::string& line) {
    std::vector<std::string> out;
    std::stringstream stream(line + ",");
    for (std::string cell; std::getline(stream, cell, ',');) out.push_back(cell);
    return out;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> header = split(line);
  std::vector<Cells> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = split(line);
    Cells row;
    for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = cells[i];
    rows.push_back(std::move(row));
  }
  return rows;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

TEST(Paper, ComparisonGivesTwelveTapsOnTheObjectForWeightedAndTwoForUncertainty) {
  const TemporaryFolder folder;
  const std::string config = (test::source_folder() / "configs/paper/comparison.yaml").string();
  const test::Ended ended =
      test::palpate({"sweep", config, "acquisition=uncertainty,weighted", "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  std::map<std::string, std::vector<double>> live;
  std::map<std::string, int> runs;
  for (const Cells& row : read_csv(test::only_run(folder.path() / "runs") / "results.csv")) {
    ++runs[row.at("acquisition")];
    const std::string hit = row.at("first_hit_tap");
    if (!hit.empty() && std::stoi(hit) <= 3)
      live[row.at("acquisition")].push_back(std::stod(row.at("on_surface_taps")));
    if (row.at("acquisition") == "weighted" && (hit.empty() || std::stoi(hit) > 3)) {
      EXPECT_EQ(row.at("on_surface_taps"), "0") << "without a fallback a dead start never recovers";
    }
  }
  for (const char* acquisition : {"uncertainty", "weighted"}) {
    EXPECT_EQ(runs[acquisition], 1000) << acquisition;
    EXPECT_GE(live[acquisition].size(), 380U);
    EXPECT_LE(live[acquisition].size(), 500U) << "about half of all random starts are dead";
  }
  EXPECT_EQ(median(live["weighted"]), 12.0);
  EXPECT_EQ(median(live["uncertainty"]), 2.0);
}

/// How many of 1000 starts find the object within the budget, and how many of them stall.
void expect_found(const std::vector<std::string>& overrides) {
  ResolvedConfig config = test::shipped_config("paper/object_i_right.yaml", overrides);
  int found = 0;
  int stalled = 0;
  for (int seed = 0; seed < 1000; ++seed) {
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
  EXPECT_GE(found, 970);
  EXPECT_EQ(stalled, 0);
  ::testing::Test::RecordProperty("found", found);
}

TEST(Paper, WithTheFallbackTheObjectOnTheRightIsFoundByTap17) { expect_found({}); }

TEST(Paper, WithTheFallbackTheObjectIsFoundByTap17AtRandomPlacement) { expect_found({"scene.placement=random"}); }

}  // namespace
}  // namespace palpate
