// SPDX-License-Identifier: MIT
// How often do the 95 % intervals of `palpate compare` contain what they estimate? Draws sweeps over 5, 10, 20 and 60
// seeds from recorded populations (tests/benchmark/coverage) and compares two groups of each, with 1, some and all
// other settings per seed; with one, each run is there in three copies. Each cell of the table is judged by the 99 %
// interval of its own figure: it misses where that interval lies below what the number of seeds must have, or above
// kMost. "other" is the method that `compare` does not take for so many seeds (the bootstrap below kLeastForBootstrap,
// else Student's t), of the same differences. "none" are samples without an interval, whose values are all equal: they
// count neither as covered nor as missed, because `compare` prints [-]. Values that no interval covers stand below.
//     interval_coverage SAMPLES [--seeds N] RESULTS_CSV=METRIC ...
// SAMPLES is 1000 or more: with 1000, the 99 % interval of a cell at 95 % reaches 1.8 percent to each side, at 89 %
// 2.6 percent. --seeds gives the table of 5, 10, 20 or 60 seeds alone. Exit code 1: a cell misses.
#include "support/clusters.hpp"
#include "support/populations.hpp"

#include <algorithm>
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

/// Percent that must be covered.
struct Must {
  std::size_t seeds;
  double least;
};
constexpr Must kMusts[] = {{5, 89.0}, {10, 91.0}, {20, 91.0}, {60, 93.0}};
constexpr double kMost = 98.0;
constexpr int kLeastSamples = 1000;

/// The differences, by the method that is not taken for so many seeds.
Coverage other_method(const Population& from, std::size_t seeds, std::size_t others, int samples) {
  Coverage out;
  for (int sample = 0; sample < samples; ++sample) {
    Random random(static_cast<std::uint64_t>(sample), fmt::format("{} {} {}", from.name, seeds, others));
    const test::DrawnSweep drawn = test::draw_sweep(from, seeds, others, 1, random);
    Clusters differences = drawn.per_seed[1];
    for (std::size_t seed = 0; seed < seeds; ++seed) {
      for (std::size_t i = 0; i < others; ++i) differences[seed][i] -= drawn.per_seed[0][seed][i];
    }
    const MeanEstimate found = seeds < kLeastForBootstrap ? bootstrap_mean(differences) : estimate_mean(differences);
    out.add(found.interval, drawn.truths[1] - drawn.truths[0]);
  }
  return out;
}

std::string cell(const Coverage& one) {
  if (one.all == 0) return "-";
  return fmt::format("{:.1f} [{:.1f}, {:.1f}]", one.percent(), one.bounds().low, one.bounds().high);
}

constexpr const char* kLine = "{:<18} {:>5} {:>6} {:>6}  {:>17} {:>17} {:>6}  {:>17}  {}\n";

/// Returns whether the cell has what it must have.
bool print(const std::string& name, const Must& must, const std::string& others, const std::string& copies,
           const Coverages& found, const Coverage& other) {
  const bool good = found.means.within(must.least, kMost) && found.differences.within(must.least, kMost);
  fmt::print(kLine, name, must.seeds, others, copies, cell(found.means), cell(found.differences),
             found.means.none + found.differences.none, cell(other), good ? "" : "MISSES");
  std::fflush(stdout);
  return good;
}

/// Returns how many cells miss.
int table(const std::vector<Population>& populations, int samples, const std::vector<Must>& musts) {
  int missed = 0;
  fmt::print(kLine, "population", "seeds", "others", "copies", "means", "differences", "none", "other", "");
  for (const Must& must : musts) {
    Coverages all;
    Coverage all_other;
    for (const Population& one : populations) {
      std::vector<std::size_t> others{1, std::min<std::size_t>(3, one.others()), one.others()};
      others.erase(std::unique(others.begin(), others.end()), others.end());
      for (const std::size_t count : others) {
        const int copies = count == 1 ? 3 : 1;
        const Coverages found = test::coverages_of(one, must.seeds, count, copies, samples);
        const Coverage other = other_method(one, must.seeds, count, samples);
        if (!print(one.name, must, std::to_string(count), std::to_string(copies), found, other)) ++missed;
        all.means.add(found.means);
        all.differences.add(found.differences);
        all_other.add(other);
      }
    }
    print("all", must, "", "", all, all_other);
  }
  return missed;
}

/// Means of values that are drawn from a distribution whose mean is known.
void print_drawn(const std::string& name, double truth, int samples, const std::vector<Must>& musts,
                 const std::function<double(Random&)>& value) {
  for (const Must& must : musts) {
    const std::size_t seeds = must.seeds;
    Coverage found;
    for (int sample = 0; sample < samples; ++sample) {
      Random random(static_cast<std::uint64_t>(sample), fmt::format("{} {}", name, seeds));
      std::vector<double> values(seeds);
      for (double& one : values) one = value(random);
      found.add(mean_of_sample(test::each_alone(values)).interval, truth);
    }
    fmt::print("{:<18} {:>5}  {:>17} {:>6}\n", name, seeds, cell(found), found.none);
  }
}

double normal(Random& random) { return normal_quantile(random.uniform() + 0x1.0p-54); }

int run(int samples, const std::vector<Must>& musts, const std::vector<std::string>& arguments) {
  std::vector<Population> populations;
  for (const std::string& one : arguments) {
    const auto sign = one.rfind('=');
    populations.push_back(test::read_population(one.substr(0, sign), one.substr(sign + 1)));
    fmt::print("{}: {}, {} groups, {} other settings, {} seeds\n", populations.back().name, one.substr(sign + 1),
               populations.back().groups(), populations.back().others(), populations.back().seeds());
  }
  const int missed = populations.empty() ? 0 : table(populations, samples, musts);
  fmt::print("\n{:<18} {:>5}  {:>17} {:>6}\n", "values drawn", "seeds", "means", "none");
  print_drawn("lognormal", std::exp(0.5), samples, musts, [](Random& random) { return std::exp(normal(random)); });
  print_drawn("one in ten fails", 0.9 * 1.0 + 0.1 * 10.0, samples, musts,
              [](Random& random) { return random.uniform() < 0.1 ? 10.0 : 1.0 + 0.1 * normal(random); });
  fmt::print("\n{} cells miss\n", missed);
  return missed == 0 ? 0 : 1;
}

/// The numbers of seeds that the words select, which follow the number of samples; removes these words.
std::vector<Must> take_musts(std::vector<std::string>& words) {
  std::vector<Must> all(std::begin(kMusts), std::end(kMusts));
  if (words.empty() || words[0] != "--seeds") return all;
  if (words.size() == 1) throw std::runtime_error("--seeds: needs 5, 10, 20 or 60 behind it");
  const std::string wanted = words[1];
  words.erase(words.begin(), words.begin() + 2);
  all.erase(
      std::remove_if(all.begin(), all.end(), [&](const Must& one) { return std::to_string(one.seeds) != wanted; }),
      all.end());
  if (all.empty()) throw std::runtime_error("--seeds: takes 5, 10, 20 or 60, not " + wanted);
  return all;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  try {
    if (count < 2 || std::atoi(words[1]) < palpate::kLeastSamples)
      throw std::runtime_error("interval_coverage SAMPLES [--seeds N] RESULTS_CSV=METRIC ..., SAMPLES of 1000 or more");
    std::vector<std::string> rest(words + 2, words + count);
    const auto musts = palpate::take_musts(rest);
    return palpate::run(std::atoi(words[1]), musts, rest);
  } catch (const std::exception& trouble) {
    fmt::print(stderr, "{}\n", trouble.what());
    return 2;
  }
}
