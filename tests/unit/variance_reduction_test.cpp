// SPDX-License-Identifier: MIT
// Looking ahead, beside what it is an abbreviation of: the error that is expected after a tap, outline by outline.
#include "scene/scene_options.hpp"
#include "support/mocks.hpp"
#include "support/testing.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace palpate::test {
namespace {

constexpr int kPlaces = 40;
constexpr int kOutlines = 128;

bool outline_holds(const HypothesisSample& sample, int outline, int place) {
  return (sample.holds(outline / 64, place) >> static_cast<unsigned>(outline % 64) & 1U) != 0;
}

/// Outlines of chance, of which neighbouring places are much alike; a few places are in all or in none.
WrittenBelief some_belief() {
  WrittenBelief out;
  out.lines.starts = Points3::Zero(kPlaces, 3);
  out.arrays[quantity::kObjectProbability] = Eigen::VectorXd::Constant(kPlaces, 0.3);
  out.sample.count = kOutlines;
  out.sample.holds.setZero(kOutlines / 64, kPlaces);
  out.sample.expected_discovery_area.resize(kPlaces);
  Random random(5, "variance reduction test");
  for (int k = 0; k < kOutlines; ++k) {
    bool on = random.uniform() < 0.4;
    for (int i = 0; i < kPlaces; ++i) {
      if (random.uniform() < 0.2) on = !on;
      const bool held = i == 7 || (i != 9 && on);
      if (held) out.sample.holds(k / 64, i) |= std::uint64_t{1} << static_cast<unsigned>(k % 64);
    }
  }
  for (int i = 0; i < kPlaces; ++i) out.sample.expected_discovery_area(i) = i % 5 == 0 ? 1e-4 * i : 0.0;
  return out;
}

/// The sum over all places of the square that is expected of the error, where `counts` says which outlines there are:
/// the best that can be shown is their mean.
double expected_square(const HypothesisSample& sample, const std::vector<int>& outlines) {
  double sum = 0.0;
  for (int place = 0; place < kPlaces; ++place) {
    double mean = 0.0;
    for (const int k : outlines)
      mean += outline_holds(sample, k, place) ? 1.0 / static_cast<double>(outlines.size()) : 0.0;
    sum += mean * (1.0 - mean);
  }
  return sum;
}

/// What a tap at each place is expected to settle, square metres.
std::vector<double> expected_to_settle(const WrittenBelief& belief, const Area& area) {
  std::vector<int> all(kOutlines);
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> out;
  for (int x = 0; x < kPlaces; ++x) {
    std::vector<int> with, without;
    for (const int k : all) (outline_holds(belief.sample, k, x) ? with : without).push_back(k);
    double gain = 0.0;
    if (!with.empty() && !without.empty()) {
      const double share = static_cast<double>(with.size()) / kOutlines;
      gain = expected_square(belief.sample, all) - share * expected_square(belief.sample, with) -
             (1.0 - share) * expected_square(belief.sample, without);
    }
    out.push_back(gain * area.width * area.depth / kPlaces);
  }
  return out;
}

/// Returns the scores on a desk of this area.
std::vector<double> scored(const WrittenBelief& belief, const Area& area, double find) {
  SceneOptions options;
  options.area.width = area.width;
  options.area.depth = area.depth;
  const auto scene = build_scene(options, 1, shared_host());
  const Context context{shared_host(), *scene, 1, nullptr};
  Eigen::VectorXd out(kPlaces);
  context
      .create<Acquisition>(
          choose(shared_host(), "acquisition", "variance_reduction", fmt::format("{{new_object_weight: {}}}", find)))
      ->score(belief, out);
  return {out.data(), out.data() + kPlaces};
}

TEST(VarianceReduction, ScoresByTheErrorThatATapIsExpectedToTakeOffAndByWhatItIsExpectedToFind) {
  const WrittenBelief belief = some_belief();
  for (const Area& desk : {Area{0.23, 0.23}, Area{0.12, 0.20}}) {
    for (const double find : {0.0, 1.5}) {
      std::vector<double> expected = expected_to_settle(belief, desk);
      for (int x = 0; x < kPlaces; ++x)
        expected[static_cast<std::size_t>(x)] += find * belief.sample.expected_discovery_area(x);
      const double most = *std::max_element(expected.begin(), expected.end());
      for (double& one : expected) one /= most;
      EXPECT_THAT(scored(belief, desk, find), testing::Pointwise(testing::DoubleNear(1e-9), expected));
    }
  }
}

TEST(VarianceReduction, FindsBeforeItSettlesOnADeskWhereMoreThingsMayBe) {
  WrittenBelief belief = some_belief();
  const Area desk{0.46, 0.46};
  const std::vector<double> settles = expected_to_settle(belief, desk);
  const double settled = *std::max_element(settles.begin(), settles.end());
  // Twice the worth, as the sides are twice as long; and a score above 1, up to 2, where most is to be found.
  for (const auto& [worth, most] : {std::pair{0.1, 1.0}, {1.4, 1.4}, {10.0, 2.0}}) {
    belief.sample.expected_discovery_area.setZero();
    belief.sample.expected_discovery_area(9) = worth * settled / (2.0 * 1.5);  // a place of which nothing is known else
    const std::vector<double> scores = scored(belief, desk, 1.5);
    EXPECT_NEAR(*std::max_element(scores.begin(), scores.end()), most, 1e-9);
    EXPECT_NEAR(scores[9], worth > 2.0 ? 2.0 : worth, 1e-9);
  }
}

TEST(VarianceReduction, TakesEachPlaceForItselfWhereTheFootprintKnowsNoOutlines) {
  WrittenBelief belief;
  belief.lines.starts = Points3::Zero(4, 3);
  belief.arrays[quantity::kObjectProbability] = Eigen::VectorXd{{0.0, 0.25, 0.5, 1.0}};
  Eigen::VectorXd out(4);
  make<Acquisition>(shared_host(), "variance_reduction", "{}")->score(belief, out);
  EXPECT_THAT(std::vector<double>(out.data(), out.data() + 4), testing::ElementsAre(0.0, 0.75, 1.0, 0.0));
}

TEST(VarianceReduction, IsFlatWhereAllIsSettledAndNothingIsLeft) {
  WrittenBelief belief = some_belief();
  belief.sample.holds.setZero();
  belief.sample.expected_discovery_area.setZero();
  Eigen::VectorXd out(kPlaces);
  make<Acquisition>(shared_host(), "variance_reduction", "{}")->score(belief, out);
  EXPECT_EQ(out, Eigen::VectorXd::Zero(kPlaces));
}

}  // namespace
}  // namespace palpate::test
