// SPDX-License-Identifier: MIT
// The promise of the tie rule: engine, threads and instruction set decide no tap.
#include "math/instructions.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace palpate {
namespace {

// PALPATE_LONG=1, as in ./check --long, takes 200.
const int kSeeds = test::brief() ? 10 : std::getenv("PALPATE_LONG") != nullptr ? 200 : 20;

std::vector<int> taps_of(const ExperimentOptions& options) {
  Experiment experiment(options, {test::shared_host()});
  test::Collector collector;
  experiment.run(collector);
  std::vector<int> out;
  for (const TapRecord& tap : collector.taps) out.push_back(tap.candidate);
  return out;
}

/// Ways to compute the same, overrides and a value of PALPATE_INSTRUCTIONS.
std::vector<std::pair<std::vector<std::string>, std::string>> ways() {
  std::vector<std::pair<std::vector<std::string>, std::string>> out;
  for (const char* engine : {"belief.engine.type=dense", "belief.engine.type=grid", "belief.engine.type=lowrank"}) {
    for (const Instructions set : math::instruction_sets()) out.push_back({{engine}, math::name_of(set)});
    out.push_back({{engine, "belief.engine.threads=2"}, ""});
  }
  return out;
}

class SameTaps : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  ExperimentOptions options(std::vector<std::string> overrides) const {
    const auto& [config, acquisition] = GetParam();
    overrides.push_back(fmt::format("acquisition={}", acquisition));
    return test::shipped_config(fmt::format("paper/{}.yaml", config), overrides).options;
  }
};

TEST_P(SameTaps, OnEveryEngineOneAndTwoThreadsAndEveryInstructionSet) {
  std::vector<std::vector<int>> expected;
  for (const auto& [way, set] : ways()) {
    const test::EnvironmentVariable variable("PALPATE_INSTRUCTIONS", set);
    ExperimentOptions one = options(way);
    for (int seed = 0; seed < kSeeds; ++seed) {
      one.seed = seed;
      const std::vector<int> taps = taps_of(one);
      if (static_cast<int>(expected.size()) == seed) {
        expected.push_back(taps);
      } else {
        ASSERT_EQ(taps, expected[static_cast<std::size_t>(seed)])
            << fmt::format("{} {}, seed {}", fmt::join(way, " "), set, seed);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SameTaps,
                         testing::Combine(testing::Values("object_i", "object_i_right", "object_ii"),
                                          testing::Values("uncertainty", "weighted")),
                         [](const auto& one) {
                           return fmt::format("{}_{}", std::get<0>(one.param), std::get<1>(one.param));
                         });

TEST(TieRule, WithoutItRoundingDecidesTaps) {
  int different = 0;
  const auto by_engine = [](const std::string& engine) {
    return test::shipped_config("paper/object_i.yaml",
                                {"acquisition=weighted", "choice.tie_tolerance=0", "belief.engine.type=" + engine})
        .options;
  };
  ExperimentOptions dense = by_engine("dense");
  ExperimentOptions lowrank = by_engine("lowrank");
  for (dense.seed = 0; dense.seed < kSeeds; ++dense.seed) {
    lowrank.seed = dense.seed;
    different += taps_of(dense) != taps_of(lowrank) ? 1 : 0;
  }
  EXPECT_GT(different, 0) << "if rounding decided nothing, the tests above would show nothing";
}

}  // namespace
}  // namespace palpate
