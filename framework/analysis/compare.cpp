// SPDX-License-Identifier: MIT
#include "analysis/compare.hpp"

#include "analysis/groups.hpp"
#include "sweep/results_after_taps.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/erase.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace palpate {
namespace {

using Values = std::vector<std::string>;

/// Value of a job and its unit of statistics.
struct ValueOfUnit {
  JobValue value;
  std::string unit;
};

/// The jobs of a group, sorted by their values of the pairing keys. The order of jobs in the sweep therefore has no
/// effect.
using JobOutcomes = std::map<Values, ValueOfUnit>;

struct GroupOutcomes {
  Values values;
  JobOutcomes outcomes;
  int never = 0;  ///< number of counted jobs that never reached the checkpoint Comparison::occasion
};

/// Sorts the groups by their values of the first key, then of the second, and so on. Values are in the order of the
/// sweep.
std::vector<JobGroup> by_keys(std::vector<JobGroup> groups) {
  std::vector<std::map<std::string, std::size_t>> ranks;  // ranks of the values, one map per key
  for (const JobGroup& group : groups) {
    ranks.resize(group.values.size());
    for (std::size_t i = 0; i < ranks.size(); ++i) ranks[i].emplace(group.values[i], ranks[i].size());
  }
  const auto comes_before = [&](const JobGroup& one, const JobGroup& other) {
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      if (one.values[i] != other.values[i]) return ranks[i].at(one.values[i]) < ranks[i].at(other.values[i]);
    }
    return false;
  };
  std::sort(groups.begin(), groups.end(), comes_before);
  return groups;
}

/// Sorts the jobs into groups and counts the jobs that the condition leaves out.
std::vector<GroupOutcomes> collect(const Sweep& sweep, const std::vector<Row>& results, const Values& columns,
                                   const CompareQuery& query, const StatisticalUnits& units, Comparison& out) {
  const JobCondition where(sweep, columns, query.where);
  const Values paired = others(sweep.keys, query.by);
  std::vector<GroupOutcomes> groups;
  for (const JobGroup& group : by_keys(group_jobs(sweep, results, query.by))) {
    groups.push_back({group.values, {}, 0});
    for (const JobResult& one : group.jobs) {
      const auto& [job, row] = one;
      ValueOfUnit outcome{value_of_job(row, query.metric, "--metric"), units.of(one)};
      if (!where.keeps(one)) {
        out.left_out.add(outcome.value.status);
        outcome.value = {ValueStatus::left_out};
      }
      if (outcome.value.status == ValueStatus::counted && row->flag(kReached) == false) ++groups.back().never;
      Values pairing;
      for (const std::string& key : paired) pairing.push_back(value_of(sweep, *job, key));
      // A list may contain the same job several times. The first copy in one group is then paired with the first copy
      // in the other group, and so on.
      pairing.emplace_back();
      JobOutcomes& outcomes = groups.back().outcomes;
      for (int repeat = 1; !outcomes.emplace(pairing, outcome).second; ++repeat)
        pairing.back() = std::to_string(repeat);
    }
  }
  return groups;
}

ComparedGroup summarise(const GroupOutcomes& collected, bool only_mean) {
  ComparedGroup out;
  out.values = shown_values(collected.values);
  out.name = fmt::format("{}", fmt::join(out.values, ", "));
  out.never = collected.never;
  std::vector<double> values;
  UnitClusters units;
  for (const auto& [pairing, outcome] : collected.outcomes) {
    out.counts.add(outcome.value.status);
    if (outcome.value.status != ValueStatus::counted) continue;
    values.push_back(outcome.value.value);
    units.add(outcome.unit, outcome.value.value);
  }
  out.mean = only_mean ? estimate_mean(units.clusters()) : mean_of_sample(units.clusters());
  if (only_mean) out.mean.interval.reset();
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  out.median = quantile(values, 0.5);
  out.low_10 = quantile(values, 0.1);
  out.high_90 = quantile(values, 0.9);
  return out;
}

std::vector<double> sums_of(const Clusters& clusters) {
  std::vector<double> out;
  for (const std::vector<double>& one : clusters) out.push_back(std::accumulate(one.begin(), one.end(), 0.0));
  return out;
}

ComparedPair compare_pair(const std::vector<GroupOutcomes>& groups, std::size_t first, std::size_t second, bool ratio) {
  ComparedPair out;
  out.first = first;
  out.second = second;
  const JobOutcomes& a = groups[first].outcomes;
  const JobOutcomes& b = groups[second].outcomes;
  UnitClusters of_a;
  UnitClusters of_b;
  UnitClusters differences;
  double largest = 0.0;
  const auto add = [&](const ValueOfUnit& one, const ValueOfUnit& other) {
    const ValueStatus status = std::min(one.value.status, other.value.status);
    if (status == ValueStatus::counted) {
      // Pairs with the same seed have the same unit. Copies of one pair of runs also have the same unit.
      const std::string unit = one.unit + "-" + other.unit;
      of_a.add(unit, one.value.value);
      of_b.add(unit, other.value.value);
      differences.add(unit, one.value.value - other.value.value);
      largest = std::max({largest, std::abs(one.value.value), std::abs(other.value.value)});
    } else if (status != ValueStatus::left_out ||
               std::max(one.value.status, other.value.status) > ValueStatus::without_partner) {
      out.lost.add(status);
    }
  };
  for (const auto& [pairing, outcome] : a) {
    const auto partner = b.find(pairing);
    add(outcome, partner != b.end() ? partner->second : ValueOfUnit{{ValueStatus::without_partner}, ""});
  }
  for (const auto& [pairing, outcome] : b) {
    if (a.count(pairing) == 0) add({{ValueStatus::without_partner}, ""}, outcome);
  }
  out.difference = mean_of_sample(differences.clusters(), largest);
  out.spread = spread_of_units(differences.clusters(), largest);
  if (ratio) out.ratio = bootstrap_ratio(sums_of(of_a.clusters()), sums_of(of_b.clusters()));
  out.test = signed_rank_test(cluster_means(of_a.clusters()), cluster_means(of_b.clusters()));
  return out;
}

void adjust(std::vector<ComparedPair>& pairs) {
  std::vector<double> p;
  for (const ComparedPair& pair : pairs) {
    if (pair.test.p) p.push_back(*pair.test.p);
  }
  if (p.size() < 2) return;
  const std::vector<double> adjusted = holm_adjusted(p);
  auto next = adjusted.begin();
  for (ComparedPair& pair : pairs) {
    if (pair.test.p) pair.p_holm = *next++;
  }
}

/// Returns a name without blanks, so that "weighted,rbf" also names the group "weighted, rbf".
std::string without_blanks(const std::string& name) { return boost::algorithm::erase_all_copy(name, " "); }

/// Groups that are compared with each other. These are the groups of one scene, because results on different scenes are
/// not comparable. If all keys of `--by` belong to the scene, one block has all groups.
struct GroupsWithBaseline {
  std::vector<std::size_t> groups;
  std::size_t baseline = 0;
};

/// Returns for each key whether it belongs to the scene. If all keys belong to the scene, returns false for each, so
/// that the scenes are compared.
std::vector<bool> scene_places(const Sweep& sweep, const Values& by) {
  const Values scenes = scene_keys(sweep);
  std::vector<bool> out;
  for (const std::string& key : by) out.push_back(is_one_of(scenes, key));
  if (std::all_of(out.begin(), out.end(), [](bool one) { return one; })) out.assign(by.size(), false);
  return out;
}

/// Returns the values whose flag in `places` equals `wanted`, joined by commas.
std::string values_at(const Values& values, const std::vector<bool>& places, bool wanted) {
  Values out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (places[i] == wanted) out.push_back(values[i]);
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

/// Returns the blocks of groups. `kept`: indices of the groups with jobs that satisfy the condition. The baseline of a
/// block is its first group.
std::vector<GroupsWithBaseline> blocks_of(const std::vector<ComparedGroup>& groups,
                                          const std::vector<std::size_t>& kept, const std::vector<bool>& scenes) {
  std::vector<GroupsWithBaseline> out;
  std::map<std::string, std::size_t> known;
  for (const std::size_t i : kept) {
    const auto [at, is_new] = known.emplace(values_at(groups[i].values, scenes, true), out.size());
    if (is_new) out.push_back({{}, i});
    out[at->second].groups.push_back(i);
  }
  return out;
}

/// Sets the baseline of each block to the group that --baseline names. --baseline may leave out the values of the
/// scene; it then names one group per scene. Removes blocks without such a group. Throws Error if no block has one.
void choose_baselines(std::vector<GroupsWithBaseline>& blocks, const std::vector<ComparedGroup>& groups,
                      const std::vector<bool>& scenes, const std::string& name) {
  const std::string wanted = without_blanks(name);
  const auto is_named = [&](const ComparedGroup& one) {
    return without_blanks(one.name) == wanted || without_blanks(values_at(one.values, scenes, false)) == wanted;
  };
  std::vector<GroupsWithBaseline> out;
  for (const GroupsWithBaseline& block : blocks) {
    for (const std::size_t i : block.groups) {
      if (is_named(groups[i])) out.push_back({block.groups, i});
    }
  }
  blocks = std::move(out);
  if (!blocks.empty()) return;
  Values names;
  for (const ComparedGroup& one : groups) {
    if (is_named(one))
      throw Error("command line", fmt::format("--baseline: --where excludes all jobs of '{}'", name),
                  "name another group");
    names.push_back(one.name);
    if (const std::string rest = values_at(one.values, scenes, false); !is_one_of(names, rest)) names.push_back(rest);
  }
  throw Error("command line", fmt::format("--baseline: there is no group '{}'", name), suggestion(name, names));
}

/// Adds to `apart` the indices of pairing keys for which the two groups have no value in common.
void find_apart(const JobOutcomes& a, const JobOutcomes& b, std::set<std::size_t>& apart) {
  const std::size_t places = a.begin()->first.size() - 1;  // The last value only distinguishes copies of a job.
  for (std::size_t place = 0; place < places; ++place) {
    std::set<std::string> values;
    for (const auto& [pairing, outcome] : a) values.insert(pairing[place]);
    const auto is_new = [&](const auto& job) { return values.count(job.first[place]) == 0; };
    if (std::all_of(b.begin(), b.end(), is_new)) apart.insert(place);
  }
}

/// Adds the pairs of each block: all pairs, or only the pairs with the baseline if there are many groups.
void add_pairs(const std::vector<GroupsWithBaseline>& blocks, const std::vector<GroupOutcomes>& groups,
               const CompareQuery& query, Comparison& out) {
  for (const GroupsWithBaseline& block : blocks) {
    const bool one_baseline = query.baseline || block.groups.size() > kMostGroupsInPairs;
    out.one_baseline = out.one_baseline || one_baseline;
    for (auto second = block.groups.begin(); second != block.groups.end(); ++second) {
      if (one_baseline && *second != block.baseline) continue;
      for (auto first = one_baseline ? block.groups.begin() : second + 1; first != block.groups.end(); ++first) {
        if (first != second) out.pairs.push_back(compare_pair(groups, *first, *second, query.ratios));
      }
    }
  }
  adjust(out.pairs);
}

/// Throws Error with the reason if no group has a value.
void check_values(const Comparison& made, const Sweep& sweep) {
  int without_value = 0;
  for (const ComparedGroup& group : made.groups) {
    if (group.mean.count > 0) return;
    without_value += group.counts.of(ValueStatus::without_value);
  }
  if (made.left_out.all() == made.jobs)
    throw Error("command line", fmt::format("--where: matches none of the {} jobs", made.jobs),
                "check the values in results.csv, or in the files that --at or --until leave beside it");
  if (without_value == 0)
    throw Error(sweep.directory.string(), "none of the jobs to compare ended well",
                "see the reasons with 'palpate status'");
  const RecordField* field = find_summary_field(made.metric.name);
  throw Error("command line", fmt::format("--metric: no job has a value of '{}'", made.metric.name),
              field != nullptr ? field->when_null : "");
}

}  // namespace

std::vector<double> Comparison::means() const {
  std::vector<double> out;
  for (const ComparedGroup& group : groups) {
    if (group.mean.count > 0) out.push_back(group.mean.mean);
  }
  return out;
}

bool Comparison::has_copies() const {
  return !by_seed && std::any_of(groups.begin(), groups.end(),
                                 [](const ComparedGroup& one) { return one.mean.clusters < one.mean.count; });
}

Comparison compare(const Sweep& sweep, const std::vector<Row>& results, const CompareQuery& query) {
  if (results.empty())
    throw Error(sweep.directory.string(), "no job of this sweep has ended", "run it with 'palpate resume'");
  check_group_keys(sweep, query.by);
  const Values columns = names_of(results);
  Comparison out;
  out.metric = find_metric(sweep, query.metric, columns);
  out.by = query.by;
  out.jobs = static_cast<int>(sweep.jobs.size());
  out.pairing = varying_keys(sweep, others(sweep.keys, query.by));
  const StatisticalUnits units(sweep, results);
  out.by_seed = units.are_seeds();
  const Values paired = others(sweep.keys, query.by);
  const std::vector<GroupOutcomes> groups = collect(sweep, results, columns, query, units, out);
  for (const GroupOutcomes& group : groups)
    out.groups.push_back(summarise(group, query.extent == CompareExtent::means));
  check_values(out, sweep);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (!out.groups[i].counts.all_are(ValueStatus::left_out)) kept.push_back(i);
  }
  const std::vector<bool> scenes = scene_places(sweep, query.by);
  std::vector<GroupsWithBaseline> blocks = blocks_of(out.groups, kept, scenes);
  out.scenes_apart = blocks.size() > 1;
  if (query.baseline) choose_baselines(blocks, out.groups, scenes, *query.baseline);
  out.compared = kept.size();
  out.ratios = query.ratios;
  if (query.extent != CompareExtent::pairs) return out;
  add_pairs(blocks, groups, query, out);
  std::set<std::size_t> apart;
  for (const ComparedPair& pair : out.pairs) {
    if (pair.lost.of(ValueStatus::without_partner) > 0)
      find_apart(groups[pair.first].outcomes, groups[pair.second].outcomes, apart);
  }
  for (const std::size_t place : apart) out.apart.push_back(paired[place]);
  return out;
}

void check_baseline(const Sweep& sweep, const std::vector<std::string>& by, const std::string& baseline) {
  std::vector<ComparedGroup> groups;
  std::vector<GroupsWithBaseline> blocks(1);
  for (const JobGroup& one : group_jobs(sweep, {}, by)) {
    blocks.front().groups.push_back(groups.size());
    groups.push_back(summarise({one.values, {}, 0}, true));
  }
  choose_baselines(blocks, groups, scene_places(sweep, by), baseline);
}

}  // namespace palpate
