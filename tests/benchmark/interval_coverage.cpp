// SPDX-License-Identifier: MIT
// How often do the 95 % intervals of `palpate compare` contain what they estimate? Draws sweeps over 5 to 60 seeds from
// recorded populations (tests/benchmark/coverage) and compares two groups of each, with 1, some and all other settings
// per seed; with one, each run is there in three copies. "t" and "BCa" are Student's interval and the bootstrap's of
// the same differences. Values that no interval covers stand below.
//     interval_coverage SAMPLES RESULTS_CSV=METRIC ...
#include "support/populations.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>

namespace palpate {
namespace {

using test::Coverage;
using test::Coverages;
using test::Population;

constexpr std::size_t kSeeds[] = {5, 10, 20, 40, 60};
/// Both methods are shown for few seeds, where it matters which is taken.
constexpr std::size_t kMostForMethods = 10;

/// Of the differences.
struct Methods {
  Coverage t, bca;
};

Methods methods_of(const Population& from, std::size_t seeds, std::size_t others, int samples) {
  Methods out;
  for (int sample = 0; sample < samples; ++sample) {
    Random random(static_cast<std::uint64_t>(sample), fmt::format("{} {} {}", from.name, seeds, others));
    const test::DrawnSweep drawn = test::draw_sweep(from, seeds, others, 1, random);
    Clusters differences = drawn.per_seed[1];
    for (std::size_t seed = 0; seed < seeds; ++seed) {
      for (std::size_t i = 0; i < others; ++i) differences[seed][i] -= drawn.per_seed[0][seed][i];
    }
    const double truth = drawn.truths[1] - drawn.truths[0];
    const auto none_if_equal = [](std::optional<MeanInterval> interval) {
      return interval && interval->low == interval->high ? std::nullopt : interval;
    };
    out.t.add(none_if_equal(estimate_mean(differences).interval), truth);
    out.bca.add(bootstrap_mean(differences).interval, truth);
  }
  return out;
}

std::string cell(const Coverage& one) { return one.all > 0 ? fmt::format("{:.1f}", one.percent()) : "-"; }

void print_head() {
  fmt::print("{:<18} {:>6} {:>6} {:>6}  {:>6} {:>12} {:>8}  {:>6} {:>6}\n", "population", "seeds", "others", "copies",
             "means", "differences", "no int.", "t", "BCa");
}

void print(const std::string& name, std::size_t seeds, const std::string& others, int copies, const Coverages& found,
           const Methods& methods) {
  fmt::print("{:<18} {:>6} {:>6} {:>6}  {:>6} {:>12} {:>8}  {:>6} {:>6}\n", name, seeds, others, copies,
             cell(found.means), cell(found.differences), found.means.none + found.differences.none, cell(methods.t),
             cell(methods.bca));
  std::fflush(stdout);
}

void table(const std::vector<Population>& populations, int samples) {
  print_head();
  for (const std::size_t seeds : kSeeds) {
    Coverages all;
    Methods all_methods;
    for (const Population& one : populations) {
      std::vector<std::size_t> others{1, std::min<std::size_t>(3, one.others()), one.others()};
      others.erase(std::unique(others.begin(), others.end()), others.end());
      for (const std::size_t count : others) {
        const int copies = count == 1 ? 3 : 1;
        const Coverages found = test::coverages_of(one, seeds, count, copies, samples);
        Methods methods;
        if (seeds <= kMostForMethods) methods = methods_of(one, seeds, count, samples);
        print(one.name, seeds, std::to_string(count), copies, found, methods);
        all.means.add(found.means);
        all.differences.add(found.differences);
        all_methods.t.add(methods.t);
        all_methods.bca.add(methods.bca);
      }
    }
    print("all", seeds, "", 0, all, all_methods);
  }
}

/// Means of values that are drawn from a distribution whose mean is known.
void print_drawn(const std::string& name, double truth, int samples, const std::function<double(Random&)>& value) {
  for (const std::size_t seeds : kSeeds) {
    Coverage found;
    for (int sample = 0; sample < samples; ++sample) {
      Random random(static_cast<std::uint64_t>(sample), fmt::format("{} {}", name, seeds));
      std::vector<double> values(seeds);
      for (double& one : values) one = value(random);
      found.add(mean_of_sample(each_alone(values)).interval, truth);
    }
    fmt::print("{:<18} {:>6}  {:>6} {:>8}\n", name, seeds, cell(found), found.none);
  }
}

double normal(Random& random) { return normal_quantile(random.uniform() + 0x1.0p-54); }

int run(int samples, const std::vector<std::string>& arguments) {
  std::vector<Population> populations;
  for (const std::string& one : arguments) {
    const auto sign = one.rfind('=');
    populations.push_back(test::read_population(one.substr(0, sign), one.substr(sign + 1)));
    fmt::print("{}: {}, {} groups, {} other settings, {} seeds\n", populations.back().name, one.substr(sign + 1),
               populations.back().groups(), populations.back().others(), populations.back().seeds());
  }
  if (!populations.empty()) table(populations, samples);
  fmt::print("\n{:<18} {:>6}  {:>6} {:>8}\n", "values drawn", "seeds", "means", "no int.");
  const int drawn = 5 * samples;
  print_drawn("lognormal", std::exp(0.5), drawn, [](Random& random) { return std::exp(normal(random)); });
  print_drawn("one in ten fails", 0.9 * 1.0 + 0.1 * 10.0, drawn,
              [](Random& random) { return random.uniform() < 0.1 ? 10.0 : 1.0 + 0.1 * normal(random); });
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  try {
    if (count < 2 || std::atoi(words[1]) < 1)
      throw std::runtime_error("interval_coverage SAMPLES RESULTS_CSV=METRIC ...");
    return palpate::run(std::atoi(words[1]), {words + 2, words + count});
  } catch (const std::exception& trouble) {
    fmt::print(stderr, "{}\n", trouble.what());
    return 2;
  }
}
