// SPDX-License-Identifier: MIT
// Is `stop.expected_rmse` right? Runs the default strategy over seven scenes, objects placed at random, and asks after
// each tap whether the rule would have stopped there, for several bounds at once. "wrong" are stops at which the true
// rmse was above the bound, in percent of all stops; "tap" is the median tap of the stop; "good at" that from which on
// the true rmse stayed below the bound; a run that has none counts as one tap more than the budget.
//     stopping_table FIRST_SEED LAST_SEED [KEY=VALUE ...]
#include "support/stopping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

namespace palpate {
namespace {

constexpr double kBounds[] = {0.01, 0.015, 0.02};

struct Tally {
  int stopped = 0;
  int wrong = 0;
  std::vector<int> stops, good;

  void add(const test::Stop& stop, int never) {
    stopped += stop.tap ? 1 : 0;
    wrong += stop.tap && stop.rmse > stop.bound ? 1 : 0;
    stops.push_back(stop.tap.value_or(never));
    good.push_back(stop.good_from.value_or(never));
  }
};

int median(std::vector<int> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print(const std::string& scene, double bound, const Tally& tally) {
  fmt::print("{:>6.1f}  {:<13}  {:>5}  {:>7}  {:>5.1f}  {:>4}  {:>7}\n", bound * 100, scene, tally.stops.size(),
             tally.stopped, tally.stopped > 0 ? 100.0 * tally.wrong / tally.stopped : 0.0, median(tally.stops),
             median(tally.good));
}

int table(int first, int last, const std::vector<std::string>& overrides) {
  fmt::print("{:>6}  {:<13}  {:>5}  {:>7}  {:>5}  {:>4}  {:>7}\n", "bound", "scene", "runs", "stopped", "wrong", "tap",
             "good at");
  std::vector<Tally> all(std::size(kBounds));
  for (const std::string& scene : test::stopping_scenes()) {
    std::vector<Tally> here(std::size(kBounds));
    for (int seed = first; seed <= last; ++seed) {
      const test::Moments run = test::moments(scene, seed, overrides);
      for (std::size_t i = 0; i < std::size(kBounds); ++i) {
        const test::Stop stop = test::stop_of(run, kBounds[i]);
        here[i].add(stop, static_cast<int>(run.size()));
        all[i].add(stop, static_cast<int>(run.size()));
      }
    }
    for (std::size_t i = 0; i < std::size(kBounds); ++i) print(scene, kBounds[i], here[i]);
    std::fflush(stdout);
  }
  for (std::size_t i = 0; i < std::size(kBounds); ++i) print("all", kBounds[i], all[i]);
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  if (count < 3 || std::atoi(words[1]) > std::atoi(words[2])) {
    fmt::print(stderr, "usage: stopping_table FIRST_SEED LAST_SEED [KEY=VALUE ...]\n");
    return 2;
  }
  try {
    return palpate::table(std::atoi(words[1]), std::atoi(words[2]), {words + 3, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
