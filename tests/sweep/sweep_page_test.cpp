// SPDX-License-Identifier: MIT
// The page of a large sweep has an even selection of its jobs and the results of all.
#include "report/page/sweep_page.hpp"

#include "analysis/compare_plan.hpp"
#include "support/large_sweep.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>

namespace palpate {
namespace {

using test::FakedJob;
using test::large_sweep;
using test::TemporaryFolder;

constexpr int kSeeds = 1000;

/// The sweep is written once, because on a slow disk this takes longer than the tests.
class LargeSweep : public ::testing::Test {
 protected:
  struct Written {
    TemporaryFolder folder;
    Sweep sweep = large_sweep(folder.path() / "many" / "0123456789ab", kSeeds);
  };

  static void SetUpTestSuite() { written_ = std::make_unique<Written>(); }
  static void TearDownTestSuite() { written_.reset(); }

  static Json data(const Sweep& sweep, std::size_t most_jobs) {
    const auto quietly = [](int, int) {};
    return sweep_data(sweep, quietly, most_jobs);
  }

  const Sweep& sweep_ = written_->sweep;

 private:
  inline static std::unique_ptr<Written> written_;
};

TEST_F(LargeSweep, HasOnItsPageEveryFifthOfEachSettingWithItsNumbers) {
  const Json page = data(sweep_, 400);
  ASSERT_EQ(page.at("jobs").size(), 400U);
  std::map<std::string, std::set<std::string>> seeds;
  const Json& columns = page.at("columns");
  const auto error =
      std::find_if(columns.begin(), columns.end(), [](const Json& one) { return one["name"] == "rmse_m"; });
  ASSERT_NE(error, columns.end());
  for (std::size_t place = 0; place < page.at("jobs").size(); ++place) {
    const Json& job = page.at("jobs")[place];
    const int index = job.at("index");
    const Job& known = sweep_.jobs.at(static_cast<std::size_t>(index));
    EXPECT_EQ(job.at("id"), known.id);
    EXPECT_EQ(job.at("state"), FakedJob::failed(index) ? "failed" : "done");
    seeds[known.values[1]].insert(known.values[0]);
    for (std::size_t key = 0; key < 2; ++key) {
      const Json& swept = page.at("keys")[key];
      EXPECT_EQ(swept.at("values").at(swept.at("of_job").at(place).get<std::size_t>()), known.values[key]);
    }
    const Json& number = error->at("numbers").at(place);
    EXPECT_EQ(number, FakedJob::failed(index) ? Json() : Json(FakedJob::error(index)));
  }
  // Seeds are the units: two jobs of a seed have the same number, and other seeds have other numbers.
  std::map<std::string, std::set<std::size_t>> units;
  std::set<std::size_t> all_units;
  for (std::size_t place = 0; place < page.at("jobs").size(); ++place) {
    const int index = page.at("jobs")[place].at("index");
    units[sweep_.jobs.at(static_cast<std::size_t>(index)).values[0]].insert(
        page.at("units_of_jobs").at(place).get<std::size_t>());
    all_units.insert(page.at("units_of_jobs").at(place).get<std::size_t>());
  }
  for (const auto& [seed, numbers] : units) EXPECT_EQ(numbers.size(), 1U) << seed;
  EXPECT_EQ(all_units.size(), units.size());
  ASSERT_EQ(seeds.size(), 2U);
  EXPECT_EQ(seeds["weighted"].size(), 200U);
  EXPECT_EQ(seeds["weighted"], seeds["uncertainty"]) << "pairs stay pairs";
  EXPECT_EQ(page.at("keys")[0].at("values").size(), static_cast<std::size_t>(kSeeds));
}

TEST_F(LargeSweep, SaysOnItsPageWhatBecameOfAllJobs) {
  const std::filesystem::path gone = job_directory(sweep_, sweep_.jobs[11]);
  std::filesystem::rename(gone, gone.string() + ".aside");
  const Json page = data(sweep_, 400);
  std::filesystem::rename(gone.string() + ".aside", gone);
  EXPECT_EQ(page.at("tally"), (Json{{"jobs", 2000},
                                    {"step", 5},
                                    {"counts", {{"done", 1979}, {"failed", 20}, {"missing", 1}}},
                                    {"reasons", 1},
                                    {"failures", Json::array({{{"reason", "out of luck"},
                                                               {"jobs", 20},
                                                               {"first", 7},
                                                               {"words", "seed=3, acquisition=uncertainty"}}})}}));
}

TEST_F(LargeSweep, HasAllJobsOnItsPageWhereThereIsRoom) {
  const Json page = data(sweep_, 2000);
  EXPECT_EQ(page.at("jobs").size(), 2000U);
  EXPECT_EQ(page.at("tally").at("step"), 1);
  EXPECT_EQ(data(sweep_, 1999).at("jobs").size(), 1000U) << "one more than there is room for";
}

TEST(SweepPage, StatesWhetherAComparisonWasPlannedBeforeTheFirstRun) {
  const TemporaryFolder folder;
  const Sweep sweep = large_sweep(folder.path() / "many" / "0123456789ab", 3);
  const auto planned = [&] { return sweep_data(sweep, [](int, int) {}).at("planned").get<std::string>(); };
  EXPECT_EQ(planned(),
            "No comparison was planned before the first run: comparisons on this page were chosen afterwards.");
  write_file(sweep.directory / "config.yaml",
             "name: many\ncompare: {metric: rmse_m, by: acquisition, seeds: 3, difference: 2 mm}\n");
  const std::string hash = recorded_plan({sweep.directory})->hash;
  EXPECT_EQ(planned(), "Planned before the first run (plan " + hash +
                           "): rmse_m by acquisition, 3 seeds, differences from 2 mm matter. Other comparisons on this "
                           "page were chosen afterwards.");
}

}  // namespace
}  // namespace palpate
