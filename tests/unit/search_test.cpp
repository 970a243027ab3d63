// SPDX-License-Identifier: MIT
// The initial design `search`: where it looks, when it ends, and that it is no worse for what happens on the way.
#include "experiment/initial_design.hpp"
#include "experiment/search_design.hpp"
#include "support/grids.hpp"

#include "support/runs.hpp"
#include "support/testing.hpp"

#include <array>
#include <set>

namespace palpate::test {
namespace {

const Area kArea{0.23, 0.23};

const TapResult kDesk = contact_at(0.0);
const TapResult kObject = contact_at(0.05);
const TapResult kRefused = tap_without_contact(Outcome::unreachable, 0.0, "because the test says so");

/// The first `count` places of a search that meets nothing.
std::vector<int> sequence(double smallest, const CandidateGrid& candidates, std::uint64_t seed, int count) {
  SearchDesign search(smallest, candidates, kArea, Random(seed, "initial"));
  std::vector<int> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(search.next(Allowed::Constant(candidates.size(), true)));
    search.look(candidates.target(out.back()));
  }
  return out;
}

/// Taps until a `length` x `width` box was hit, drawn anywhere on the area: the mean over `boxes`, whatever the tap.
template <class Sequence>
double mean_first_hit(double length, double width, const CandidateGrid& candidates, const Sequence& places_of) {
  constexpr int kBoxes = 300;
  double sum = 0.0;
  for (int i = 0; i < kBoxes; ++i) {
    const std::vector<int> places = places_of(static_cast<std::uint64_t>(i % 20));
    Random random(static_cast<std::uint64_t>(i), "search_test/box");
    double x, y, c, s;
    do {
      x = kArea.width * random.uniform();
      y = kArea.depth * random.uniform();
      const double angle = 3.14159265358979 * random.uniform();
      c = std::cos(angle);
      s = std::sin(angle);
    } while (std::min(x, kArea.width - x) < 0.5 * (std::abs(c) * length + std::abs(s) * width) ||
             std::min(y, kArea.depth - y) < 0.5 * (std::abs(s) * length + std::abs(c) * width));
    const auto hit = std::find_if(places.begin(), places.end(), [&](int place) {
      const Target at = candidates.target(place);
      return std::abs(c * (at.x - x) + s * (at.y - y)) <= 0.5 * length &&
             std::abs(c * (at.y - y) - s * (at.x - x)) <= 0.5 * width;
    });
    sum += static_cast<double>(hit - places.begin()) + 1.0;
  }
  return sum / kBoxes;
}

TEST(SearchDesign, FindsThePapersObjectsSoonerThanTheIssueAsksAndSmallOnesSoonerThanChance) {
  const CandidateGrid candidates = grid_by_count(kArea, 47);
  std::vector<std::vector<int>> searches;
  for (std::uint64_t seed = 0; seed < 20; ++seed) searches.push_back(sequence(0.02, candidates, seed, 60));
  const auto searched = [&](std::uint64_t seed) { return searches[seed]; };
  const auto drawn = [&](std::uint64_t seed) {
    InitialOptions options;
    options.count = 60;
    return initial_design(options, candidates, kArea, seed);
  };
  EXPECT_LE(mean_first_hit(0.16, 0.06, candidates, searched), 2.5);
  EXPECT_LE(mean_first_hit(0.03, 0.03, candidates, searched), 0.8 * mean_first_hit(0.03, 0.03, candidates, drawn));
  EXPECT_LE(mean_first_hit(0.12, 0.02, candidates, searched), 0.6 * mean_first_hit(0.12, 0.02, candidates, drawn));
}

TEST(SearchDesign, TakesThePlaceWhereMostIsThatNoTapHasStruckOff) {
  // The discs anew, from the same stream by the rule of the header, and counted one by one.
  const double smallest = 0.04;
  const CandidateGrid candidates = grid_by_spacing({0.23, 0.10}, 0.01);
  const Area area{0.23, 0.10};
  Random random(9, "initial");
  std::vector<std::array<double, 4>> discs;
  for (int i = 0; i < 16000; ++i) {
    const double radius = smallest / 2 * std::pow(0.10 / smallest, random.uniform());
    const double x = radius + (area.width - 2 * radius) * random.uniform();
    const double y = radius + (area.depth - 2 * radius) * random.uniform();
    discs.push_back({x, y, radius, 1.0});
  }
  SearchDesign search(smallest, candidates, area, Random(9, "initial"));
  const Allowed all = Allowed::Constant(candidates.size(), true);
  for (int tap = 0; tap < 12; ++tap) {
    std::vector<double> held(static_cast<std::size_t>(all.size()), 0.0);
    const auto inside = [&](const std::array<double, 4>& disc, int i) {
      return disc[2] - std::hypot(candidates.target(i).x - disc[0], candidates.target(i).y - disc[1]);
    };
    for (int i = 0; i < candidates.size(); ++i) {
      for (const auto& disc : discs) held[static_cast<std::size_t>(i)] += inside(disc, i) >= 0.0 ? disc[3] : 0.0;
    }
    const double most = *std::max_element(held.begin(), held.end());
    const int next = search.next(all);
    ASSERT_GT(most, 0);
    // Weights are kept in thousandths.
    ASSERT_GE(held[static_cast<std::size_t>(next)], (1.0 - 1e-3) * most) << "tap " << tap + 1;
    search.look(candidates.target(next));
    // An arm that is off by 2 mm and does not feel one contact in fifty may have passed it by.
    for (auto& disc : discs)
      disc[3] *= 1.0 - 0.98 * 0.5 * (1.0 + std::erf(inside(disc, next) / 0.002 / std::sqrt(2.0)));
  }
}

TEST(SearchDesign, GoesIntoTheLargestGapOnceNoDiscIsLeft) {
  // Objects of 22 cm and more hold the middle of the area: one tap there, and only what is smaller can be left.
  const CandidateGrid candidates = grid_by_count(kArea, 23);
  const std::vector<int> places = sequence(0.22, candidates, 1, 6);
  std::vector<Target> taps{candidates.target(places[0])};
  EXPECT_DOUBLE_EQ(taps[0].x, 0.115);
  EXPECT_DOUBLE_EQ(taps[0].y, 0.115);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const auto room = [&](const Target& at) {
      double out = std::min({at.x, 0.23 - at.x, at.y, 0.23 - at.y});
      for (const Target& tap : taps) out = std::min(out, std::hypot(at.x - tap.x, at.y - tap.y));
      return out;
    };
    double most = 0.0;
    for (int j = 0; j < candidates.size(); ++j) most = std::max(most, room(candidates.target(j)));
    EXPECT_DOUBLE_EQ(room(candidates.target(places[i])), most) << "tap " << i + 1;
    taps.push_back(candidates.target(places[i]));
  }
}

TEST(SearchDesign, LooksEverywhereOnceAndOnlyWhereItMay) {
  const CandidateGrid candidates = grid_by_count(kArea, 6);
  const std::vector<int> places = sequence(0.02, candidates, 4, candidates.size());
  EXPECT_EQ(std::set<int>(places.begin(), places.end()).size(), 36U);
  SearchDesign search(0.02, candidates, kArea, Random(4, "initial"));
  Allowed allowed = Allowed::Constant(36, true);
  allowed(places[0]) = false;
  EXPECT_NE(search.next(allowed), places[0]);
}

TEST(InitialSearch, EndsWithTheFirstHitAndLeavesTheRestToTheAcquisition) {
  const Finished run("paper/object_i.yaml", {"initial.design=search", "taps=8"},
                     scripted({kDesk, kDesk, kRefused, kDesk, kObject}));
  ASSERT_EQ(run.taps.size(), 8U);
  const std::vector<int> expected = sequence(0.02, run.grid(), run.config.options.seed, 5);
  std::set<int> places;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(run.taps[i].request.source, i < 5 ? Source::initial : Source::acquisition) << "tap " << i + 1;
    if (i < 5) {
      EXPECT_EQ(run.taps[i].candidate, expected[i]) << "a failed tap was a look";
    }
    places.insert(run.taps[i].candidate);
  }
  EXPECT_EQ(places.size(), 8U);
  EXPECT_EQ(run.belief().taps().initial, 5);
  EXPECT_EQ(*run.experiment.counts().first_hit_tap, 5);
}

TEST(InitialSearch, ThatMeetsNothingSpendsTheBudgetOrLooksEverywhere) {
  const Finished run("paper/object_i.yaml",
                     {"initial.design=search", "taps=12", "candidates.count=3", "choice.repeat=allow"}, scripted());
  ASSERT_EQ(run.taps.size(), 12U);
  std::set<int> places;
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(run.taps[i].request.source, Source::initial);
    places.insert(run.taps[i].candidate);
  }
  EXPECT_EQ(places.size(), 9U);
  EXPECT_NE(run.taps[9].request.source, Source::initial) << "it has looked everywhere";
  EXPECT_EQ(run.experiment.counts().stop_reason, "tap budget");
}

TEST(InitialSearch, StopsForADeviationOnlyOnceItIsOver) {
  const Finished run("paper/object_i.yaml", {"initial.design=search", "stop.max_standard_deviation=100 m"},
                     scripted({kDesk, kDesk, kObject}));
  EXPECT_EQ(run.experiment.counts().stop_reason, "max_standard_deviation");
  EXPECT_EQ(run.experiment.counts().taps, 3);
}

}  // namespace
}  // namespace palpate::test
