// SPDX-License-Identifier: MIT
// Populations of recorded jobs, from which sweeps over a few seeds are drawn: how often do the intervals of `palpate
// compare` contain the population's value?
#pragma once

#include "analysis/compare.hpp"
#include "support/support.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::test {

/// A metric of every job of a sweep: by the value of its first key (the groups), then by the values of all others but
/// the seed (the other settings), then by seed.
struct Population {
  std::string name;
  std::string metric;
  std::vector<std::vector<std::vector<double>>> values;  ///< group, other setting, seed

  std::size_t groups() const { return values.size(); }
  std::size_t others() const { return values.front().size(); }
  std::size_t seeds() const { return values.front().front().size(); }
};

/// Reads a results.csv, or a table with some of its columns: the swept keys stand before `name`. Throws
/// std::runtime_error where a job has no value.
inline Population read_population(const std::filesystem::path& file, const std::string& metric) {
  const std::string text = text_of(file);
  std::vector<std::string> keys;
  std::istringstream head(text.substr(0, text.find('\n')));
  for (std::string column; std::getline(head, column, ',') && column != "name";) {
    if (column != "job" && column != "id" && column != "seed") keys.push_back(column);
  }
  Population out{"", metric, {}};
  std::map<std::string, std::size_t> groups;
  std::map<std::string, std::size_t> others;
  for (const Cells& row : csv_rows(text)) {
    if (row.at("status") != "done" || row.at(metric).empty()) throw std::runtime_error("a job without " + metric);
    std::string rest;
    for (std::size_t i = 1; i < keys.size(); ++i) rest += row.at(keys[i]) + ", ";
    const std::size_t group = groups.emplace(row.at(keys[0]), groups.size()).first->second;
    const std::size_t other = others.emplace(rest, others.size()).first->second;
    out.name = row.at("name");
    if (group == out.values.size()) out.values.emplace_back();
    if (other == out.values[group].size()) out.values[group].emplace_back();
    out.values[group][other].push_back(std::stod(row.at(metric)));  // in the order of the seeds
  }
  return out;
}

/// A sweep as it could have been: two groups, some of the other settings, and seeds that are drawn from the population
/// with replacement, each of which counts as a seed of its own.
struct DrawnSweep {
  Sweep sweep{"runs/drawn/0123456789ab", {"group", "other", "copy", "seed"}, {}};
  std::vector<Row> results;
  std::vector<double> truths;         ///< of the groups: the population's mean over the same settings and all seeds
  std::vector<Clusters> per_seed{2};  ///< by group: all values of each seed
};

/// `others` of the other settings, each job in as many `copies`.
inline DrawnSweep draw_sweep(const Population& from, std::size_t seeds, std::size_t others, int copies,
                             Random& random) {
  DrawnSweep out;
  std::vector<std::size_t> drawn(seeds);
  for (std::size_t& one : drawn) one = random.index(from.seeds());
  std::vector<std::size_t> settings(from.others());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    settings[i] = i;
    std::swap(settings[i], settings[random.index(i + 1)]);
  }
  settings.resize(others);
  const std::size_t first = random.index(from.groups());
  const std::size_t second = (first + 1 + random.index(from.groups() - 1)) % from.groups();
  for (const std::size_t group : {first, second}) {
    double sum = 0.0;
    Clusters& clusters = out.per_seed[out.truths.size()];
    clusters.resize(seeds);
    for (const std::size_t other : settings) {
      const std::vector<double>& values = from.values[group][other];
      sum += mean_of(values) / static_cast<double>(others);
      for (std::size_t seed = 0; seed < seeds; ++seed) {
        for (int copy = 0; copy < copies; ++copy) {
          const int job = static_cast<int>(out.sweep.jobs.size());
          out.sweep.jobs.push_back(
              {job,
               "id",
               {group == first ? "a" : "b", std::to_string(other), std::to_string(copy), std::to_string(seed)}});
          Row row;
          row.add("job", job);
          row.add("status", "done");
          row.add(from.metric, values[drawn[seed]]);
          out.results.push_back(std::move(row));
        }
        clusters[seed].push_back(values[drawn[seed]]);
      }
    }
    out.truths.push_back(sum);
  }
  return out;
}

/// How often intervals contain what they estimate. Samples of equal values have none and are counted apart.
struct Coverage {
  int hits = 0;
  int all = 0;
  int none = 0;
  int per_sample = 1;  ///< intervals of one sample, which depend on each other and count as one

  void add(const std::optional<MeanInterval>& interval, double truth) {
    if (!interval) {
      ++none;
      return;
    }
    ++all;
    hits += interval->low <= truth && truth <= interval->high ? 1 : 0;
  }
  void add(const Coverage& other) {
    hits += other.hits;
    all += other.all;
    none += other.none;
    per_sample = other.per_sample;
  }
  double percent() const { return 100.0 * hits / std::max(1, all); }
  double samples() const { return static_cast<double>(std::max(1, all)) / per_sample; }
  /// Of the percentage: one standard deviation of a share that is `share` percent.
  double error(double share) const { return std::sqrt(share * (100.0 - share) / samples()); }
  /// The two-sided 99 % interval of the percentage: the score interval (Wilson 1927, Probable inference, the law of
  /// succession, and statistical inference).
  MeanInterval bounds() const {
    const double z = normal_quantile(0.995);
    const double n = samples();
    const double share = percent() / 100.0;
    const double centre = share + z * z / (2.0 * n);
    const double half = z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
    return {100.0 * (centre - half) / (1.0 + z * z / n), 100.0 * (centre + half) / (1.0 + z * z / n)};
  }
  /// Whether the percentage is between `least` and `most` as far as the samples can decide.
  bool within(double least, double most) const { return bounds().high >= least && bounds().low <= most; }
};

struct Coverages {
  Coverage means{0, 0, 0, 2};  ///< of both groups
  Coverage differences;
};

/// What `palpate compare` makes of `samples` such sweeps.
inline Coverages coverages_of(const Population& from, std::size_t seeds, std::size_t others, int copies, int samples) {
  Coverages out;
  for (int sample = 0; sample < samples; ++sample) {
    Random random(static_cast<std::uint64_t>(sample), fmt::format("{} {} {}", from.name, seeds, others));
    const DrawnSweep drawn = draw_sweep(from, seeds, others, copies, random);
    const Comparison made =
        compare(drawn.sweep, drawn.results, {{"group"}, from.metric, nullptr, {}, false, CompareExtent::pairs});
    for (std::size_t i = 0; i < 2; ++i) out.means.add(made.groups[i].mean.interval, drawn.truths[i]);
    out.differences.add(made.pairs.front().difference.interval, drawn.truths[1] - drawn.truths[0]);
  }
  return out;
}

}  // namespace palpate::test
