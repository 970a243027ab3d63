// SPDX-License-Identifier: MIT
#include "analysis/compare_report.hpp"

#include "analysis/bootstrap.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/table.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace palpate {
namespace {

using Better = RecordField::Better;
using Kind = Table::Kind;

std::string keys_text(const std::vector<std::string>& keys) {
  return one_line(fmt::format("{}", fmt::join(keys, ", ")));
}

/// Returns the scale `groups` with enough decimals to show half the width of the narrowest interval with two
/// significant digits.
DisplayScale difference_scale(const Comparison& comparison, const DisplayScale& groups) {
  std::vector<double> widths;
  for (const ComparedPair& pair : comparison.pairs) {
    const auto& ends = pair.difference.interval;
    if (ends) widths.push_back((ends->high - ends->low) / 2.0 / groups.factor);
  }
  DisplayScale scale = groups;
  scale.decimals = std::max(scale.decimals, readable_scale(Unit::none, widths, 2).decimals);
  return scale;
}

/// Returns a quantile as text. A whole number has no decimals, because a quantile of counts mostly equals one of the
/// counts.
std::string short_number(const DisplayScale& scale, double value) {
  const double shown = value / scale.factor;
  return shown == std::round(shown) && std::abs(shown) < 1e6 ? fmt::format("{:.0f}", shown) : scale.number(value);
}

/// Returns whether pairs show the numbers of groups instead of their names. Long names would make the lines too long.
bool numbered(const Comparison& comparison) {
  constexpr std::size_t kLongest = 16;
  return std::any_of(comparison.groups.begin(), comparison.groups.end(),
                     [](const ComparedGroup& group) { return group.name.size() > kLongest; });
}

/// Returns the title of the column with the number of units; "" if each job is a unit.
std::string units_title(const Comparison& comparison) {
  return comparison.by_seed ? "seeds" : comparison.has_copies() ? "units" : "";
}

std::string units_cell(const Comparison& comparison, const MeanEstimate& mean) {
  return units_title(comparison).empty() ? "" : std::to_string(mean.clusters);
}

std::string pair_name(const Comparison& comparison, const ComparedPair& pair) {
  if (numbered(comparison)) return fmt::format("{} - {}", pair.first + 1, pair.second + 1);
  return fmt::format("{} - {}", comparison.groups[pair.first].name, comparison.groups[pair.second].name);
}

/// Begins the row of a group or of a pair with the fields that both kinds of rows have.
void begin_row(Table& table, const Comparison& comparison, const std::string& where, const char* kind) {
  table.add_row();
  table.store("kind", kind);
  table.store("by", fmt::format("{}", fmt::join(comparison.by, ",")));
  table.store("metric", comparison.metric.name);
  table.store("where", where.empty() ? std::nullopt : std::optional(where));
  table.store("planned", comparison.planned);
  table.store("plan", comparison.plan);
  if (const auto& occasion = comparison.occasion)
    occasion->taps() ? table.store("at", *occasion->taps()) : table.store("until", occasion->words());
}

void store_estimate(Table& table, const Comparison& comparison, const MeanEstimate& mean) {
  const auto units = static_cast<std::int64_t>(mean.clusters);
  table.store("n", static_cast<std::int64_t>(mean.count));
  table.store("seeds", comparison.by_seed ? std::optional(units) : std::nullopt);
  table.store("units", units);
  add_mean(table.last_row(), "", mean);
}

Table group_table(const Comparison& comparison, const DisplayScale& scale, const std::string& where) {
  Table table;
  for (std::size_t i = 0; i < comparison.groups.size(); ++i) {
    const ComparedGroup& one = comparison.groups[i];
    const bool any = one.mean.count > 0;
    begin_row(table, comparison, where, "group");
    if (numbered(comparison)) table.show("#", std::to_string(i + 1));
    table.show(keys_text(comparison.by), one.name, Kind::text);
    table.store("group", one.name);
    table.show("jobs", std::to_string(one.counts.all()));
    for (const auto& [title, status] :
         {std::pair("left out", ValueStatus::left_out), std::pair("failed", ValueStatus::failed),
          std::pair("unfinished", ValueStatus::unfinished), std::pair("no value", ValueStatus::without_value)})
      table.show(title, std::to_string(one.counts.of(status)), Kind::count);
    add_counts(table.last_row(), one.counts, true);
    table.show("n", std::to_string(one.mean.count));
    table.show(units_title(comparison), units_cell(comparison, one.mean), Kind::count);
    table.show("mean [95 % interval]", scale.estimate(one.mean));
    store_estimate(table, comparison, one.mean);
    if (comparison.occasion && !comparison.occasion->taps()) table.store("never", one.never);
    const auto known = [&](double value) { return any ? std::optional(value) : std::nullopt; };
    table.show("median", any ? short_number(scale, one.median) : "-");
    table.store("median", known(one.median));
    table.show("10 % to 90 %",
               any ? fmt::format("{} to {}", short_number(scale, one.low_10), short_number(scale, one.high_90)) : "-");
    table.store("p10", known(one.low_10));
    table.store("p90", known(one.high_90));
  }
  return table;
}

std::string p_text(const std::optional<double>& p) {
  if (!p) return "-";
  if (*p < 1e-15) return "<1e-15";
  return *p < 1e-3 ? fmt::format("{:.0e}", *p) : fmt::format("{:.3f}", *p);
}

/// Words that express the sign of a difference.
struct SignWords {
  const char* up;
  const char* down;
};

SignWords words_of(const Column& metric) {
  return metric.better == Better::neither ? SignWords{"higher", "lower"} : SignWords{"better", "worse"};
}

/// Returns the number of units in which the first group has the better mean, and the number in which it has the worse
/// mean. If no direction of the metric is better, returns the numbers for the higher mean and for the lower mean.
std::pair<std::size_t, std::size_t> sides(const Comparison& comparison, const SignedRank& test) {
  if (comparison.metric.better == Better::less) return {test.lower, test.higher};
  return {test.higher, test.lower};
}

/// Returns "0.85 [0.79, 0.91]".
std::string ratio_text(const ComparedPair& pair) {
  if (!pair.ratio) return "-";
  return with_interval(pair.ratio->ratio, pair.ratio->interval, [](double one) { return fmt::format("{:.3f}", one); });
}

void store_test(Table& table, const ComparedPair& pair) {
  const SignedRank& test = pair.test;
  for (const auto& [name, status] :
       {std::pair("left_out", ValueStatus::left_out), std::pair("without_partner", ValueStatus::without_partner),
        std::pair("unfinished", ValueStatus::unfinished), std::pair("failed", ValueStatus::failed),
        std::pair("without_value", ValueStatus::without_value)})
    table.store(fmt::format("lost_{}", name), pair.lost.of(status));
  table.store("higher", static_cast<std::int64_t>(test.higher));
  table.store("equal", static_cast<std::int64_t>(test.equal));
  table.store("lower", static_cast<std::int64_t>(test.lower));
  table.store("rank_sum_higher", test.rank_sum_higher);
  table.store("rank_sum_lower", test.rank_sum_lower);
  table.store("p", test.p);
  table.store("p_exact", test.p ? std::optional(test.exact) : std::nullopt);
  table.store("p_holm", pair.p_holm);
  table.store("rank_biserial", test.effect);
}

/// Returns whether the 95 % interval of a difference lies beyond the smallest difference that matters, or within it.
std::string verdict(const ComparedPair& pair, double least) {
  const auto& ends = pair.difference.interval;
  if (ends && (ends->low >= least || ends->high <= -least)) return "larger";
  return ends && ends->low > -least && ends->high < least ? "smaller" : "not decided";
}

Table pair_table(const Comparison& comparison, const DisplayScale& scale, const std::string& where) {
  const SignWords words = words_of(comparison.metric);
  Table table;
  for (const ComparedPair& pair : comparison.pairs) {
    begin_row(table, comparison, where, "pair");
    table.show("difference", pair_name(comparison, pair), Kind::text);
    table.store("group", comparison.groups[pair.first].name);
    table.store("minus", comparison.groups[pair.second].name);
    table.show("pairs", std::to_string(pair.difference.count));
    table.show("lost", std::to_string(pair.lost.all()));
    table.show(units_title(comparison), units_cell(comparison, pair.difference), Kind::count);
    const std::string mean = with_interval(pair.difference.mean, pair.difference.interval,
                                           [&](double value) { return scale.difference(value); });
    table.show("mean [95 % interval]", pair.difference.count > 0 ? mean : "-");
    store_estimate(table, comparison, pair.difference);
    const auto least = comparison.difference;
    if (least) table.show("verdict", verdict(pair, *least));
    table.store("verdict", least ? std::optional(verdict(pair, *least)) : std::nullopt);
    std::optional<double> detectable;
    if (pair.spread) detectable = planning_sd(*pair.spread, 0.8) * detectable_effect(pair.difference.clusters, 0.8);
    table.show("detectable", scale.number(detectable));
    table.store("detectable", detectable);
    if (comparison.ratios) {
      table.show("ratio [95 % interval]", ratio_text(pair));
      table.store("ratio", pair.ratio ? std::optional(pair.ratio->ratio) : std::nullopt);
      add_interval(table.last_row(), "ratio_", pair.ratio ? pair.ratio->interval : std::nullopt);
    }
    const auto [up, down] = sides(comparison, pair.test);
    table.show(fmt::format("{}/equal/{}", words.up, words.down), fmt::format("{}/{}/{}", up, pair.test.equal, down));
    table.show("p", p_text(pair.test.p));
    if (comparison.pairs.size() > 1) table.show("p (Holm)", p_text(pair.p_holm));
    table.show("effect", pair.test.effect ? fmt::format("{:+.2f}", *pair.test.effect) : "-");
    store_test(table, pair);
  }
  return table;
}

/// Returns a remark if the mean favours one group and the majority of the units favours the other.
std::string contrary_note(const Comparison& comparison, const ComparedPair& pair) {
  const auto& ends = pair.difference.interval;
  if (!ends || (ends->low <= 0.0 && ends->high >= 0.0)) return {};
  const double gain = comparison.metric.better == Better::less ? -pair.difference.mean : pair.difference.mean;
  const auto [up, down] = sides(comparison, pair.test);
  if (up == down || (gain > 0.0) == (up > down)) return {};
  const SignWords words = words_of(comparison.metric);
  return fmt::format("{}: {} on average, but {} in most {}: {} of {}\n", pair_name(comparison, pair),
                     gain > 0.0 ? words.up : words.down, gain > 0.0 ? words.down : words.up,
                     comparison.by_seed ? "seeds" : "pairs", std::max(up, down), pair.difference.clusters);
}

std::string lost_note(const Comparison& comparison, const ComparedPair& pair) {
  const std::string reasons =
      pair.lost.words({ValueStatus::left_out, ValueStatus::without_partner, ValueStatus::unfinished,
                       ValueStatus::failed, ValueStatus::without_value});
  return reasons.empty() ? "" : fmt::format("{}: pairs lost: {}\n", pair_name(comparison, pair), reasons);
}

/// Returns a remark if there are few units.
std::string few_note(const Comparison& comparison) {
  std::size_t fewest = kEnoughUnits;
  for (const ComparedGroup& one : comparison.groups) {
    if (one.mean.count > 0) fewest = std::min(fewest, one.mean.clusters);
  }
  for (const ComparedPair& one : comparison.pairs) {
    if (one.difference.count > 0) fewest = std::min(fewest, one.difference.clusters);
  }
  return few_words(fewest, comparison.by_seed, kLeastForInterval);
}

/// Returns remarks about groups with copies of runs, and about groups and pairs that have no interval because their
/// values are equal.
std::string units_note(const Comparison& comparison) {
  std::string out;
  const auto equal = [&](const std::string& name, const MeanEstimate& mean, bool difference) {
    if (mean.clusters < kLeastForInterval || mean.interval) return;
    out += fmt::format("{} has no interval: its {} are equal in all {} and show no spread\n", name,
                       difference ? "differences" : "values", units_words(mean.clusters, comparison.by_seed));
  };
  for (const ComparedGroup& one : comparison.groups) {
    if (comparison.has_copies() && one.mean.clusters < one.mean.count)
      out += copies_words(one.name, one.mean.count, one.mean.clusters);
    equal(one.name, one.mean, false);
  }
  for (const ComparedPair& one : comparison.pairs) equal(pair_name(comparison, one), one.difference, true);
  return out;
}

/// Returns a remark about keys for which some compared groups have no value in common, with a remedy.
std::string apart_note(const Comparison& comparison) {
  std::vector<std::string> keys = comparison.apart;
  const auto seed = std::find(keys.begin(), keys.end(), "seed");
  std::string out;
  if (seed != keys.end()) {
    keys.erase(seed);
    out += "groups without a common seed have no pairs: run them on the same seeds\n";
  }
  if (keys.empty()) return out;
  return out + fmt::format("groups without a common {} have no pairs: compare them with '--by {},{}'\n",
                           keys_text(keys), one_line(fmt::format("{}", fmt::join(comparison.by, ","))),
                           one_line(fmt::format("{}", fmt::join(keys, ","))));
}

/// Returns the number of groups that have jobs but are in no pair.
std::size_t groups_without_pair(const Comparison& comparison) {
  std::set<std::size_t> paired;
  for (const ComparedPair& one : comparison.pairs) paired.insert({one.first, one.second});
  return comparison.compared - paired.size();
}

std::string remarks(const Comparison& comparison) {
  std::string out;
  const std::size_t groups = comparison.compared;
  if (const StatusCounts& left_out = comparison.left_out; left_out.all() > 0) {
    out += fmt::format("--where excludes {} of {} jobs", left_out.all(), comparison.jobs);
    const std::string ends = left_out.words({ValueStatus::failed, ValueStatus::unfinished});
    out += (ends.empty() ? "" : ", of which " + ends) + "\n";
  }
  out += few_note(comparison) + units_note(comparison);
  if (groups < 2) out += "only one group: nothing to compare\n";
  if (comparison.scenes_apart) {
    out += fmt::format("{} groups: each is compared {} of its scene\n", groups,
                       comparison.one_baseline ? "with one" : "with the others");
    if (const std::size_t alone = groups_without_pair(comparison); alone > 0)
      out += fmt::format("{} groups are in no pair: their scene has no other group, or no baseline\n", alone);
  } else if (!comparison.pairs.empty() && comparison.pairs.size() < groups * (groups - 1) / 2) {
    out += fmt::format("{} groups: each is compared with {} only\n", groups,
                       comparison.groups[comparison.pairs.front().second].name);
  }
  for (const ComparedGroup& one : comparison.groups) {
    if (one.never > 0)
      out += fmt::format("{}: {} of {} jobs never reached the goal and count with their final values\n", one.name,
                         one.never, one.mean.count);
  }
  for (const ComparedPair& pair : comparison.pairs)
    out += lost_note(comparison, pair) + contrary_note(comparison, pair);
  return out + apart_note(comparison);
}

}  // namespace

std::string compare_tables(const Comparison& comparison) {
  const DisplayScale scale = readable_scale(comparison.metric.unit, comparison.means());
  const std::string better = comparison.metric.better_words();
  std::string out =
      fmt::format("{} by {}{}{}\n", scale.title(comparison.metric.name), keys_text(comparison.by),
                  comparison.occasion ? " " + comparison.occasion->words() : "", better.empty() ? "" : "; " + better);
  out += group_table(comparison, scale, "").text();
  if (!comparison.pairs.empty()) out += "\n" + pair_table(comparison, difference_scale(comparison, scale), "").text();
  const std::string notes = remarks(comparison);
  return out + (notes.empty() ? "" : "\n" + notes);
}

std::string power_table(const Comparison& comparison, double difference, double power) {
  const DisplayScale scale = difference_scale(comparison, readable_scale(comparison.metric.unit, comparison.means()));
  const auto needed = [&](double sd) { return units_needed(difference / sd, power); };
  Table table;
  if (comparison.pairs.empty()) throw Error("command line", "--by: there is only one group", "name another key");
  for (const ComparedPair& pair : comparison.pairs) {
    const std::string name = comparison.groups[pair.first].name + " - " + comparison.groups[pair.second].name;
    if (pair.difference.clusters < 3) throw Error(name, "fewer than 3 common seeds", "run more; see 'palpate compare'");
    if (!pair.spread) throw Error(name, "the sd is 0, as all differences are equal", "choose another metric or group");
    const UnitSpread& spread = *pair.spread;
    table.add_row();
    table.show("difference", name, Kind::text);
    table.show("pilot seeds", std::to_string(pair.difference.clusters));
    table.show("sd [95 % interval]", scale.estimate(MeanEstimate{1, 1, spread.sd, spread.interval}));
    table.show("seeds needed [95 % interval]", fmt::format("{} [{}, {}]", needed(planning_sd(spread, power)),
                                                           needed(spread.interval.low), needed(spread.interval.high)));
  }
  return fmt::format("{} by {}: seeds for a difference of {} with {} % power\n{}", scale.title(comparison.metric.name),
                     keys_text(comparison.by), readable(difference, comparison.metric.unit, 6),
                     significant(100.0 * power), table.text());
}

std::string compare_legend(const std::vector<Comparison>& comparisons) {
  bool holm = false;
  bool paired = false;
  for (const Comparison& one : comparisons) {
    holm = holm || one.pairs.size() > 1;
    paired = paired || !one.pairs.empty();
  }
  const Comparison& first = comparisons.front();
  const char* const units = first.by_seed ? "seeds" : "jobs";
  std::string out = fmt::format(
      "interval: 95 % confidence interval of the mean over {} (BCa bootstrap; below {} {} Student's t).\n[-]: no "
      "interval, because of fewer than {} {} or equal values.\n",
      units, kLeastForBootstrap, units, kLeastForInterval, units);
  out += first.by_seed ? "The unit is the seed: all jobs of a seed are resampled together and count as one.\n"
                       : "The seed is not swept: the unit is the job, taken as independent of the others; copies of a "
                         "run count once.\n";
  if (!paired) return out;
  const std::vector<std::string>& pairing = first.pairing;
  out += pairing.empty() ? "pair: one job of each group.\n"
                         : fmt::format("pair: two jobs with equal {}.\n", keys_text(pairing));
  if (first.difference)
    out += "verdict: the interval shows a difference that matters (larger), a smaller one, or neither (not decided).\n";
  if (first.ratios)
    out += fmt::format(
        "ratio: mean of the first group divided by the mean of the second, over the same pairs; its interval resamples "
        "{}\n(BCa bootstrap). '-': the metric may be negative.\n",
        first.by_seed ? "seeds" : "pairs");
  out += fmt::format(
      "detectable: true difference that a two-sided paired t test finds at 5 % with 80 % power, with this number of "
      "{}.\np: two-sided Wilcoxon signed-rank test of the differences{}. Equal {} are dropped.\nIt is exact up to {} "
      "differences and uses the normal approximation for more.\n{}effect: matched-pairs rank-biserial correlation, "
      "from -1 (the first is always lower) to +1 (always higher).\n",
      units, first.by_seed ? " of the means per seed" : "", first.by_seed ? "seeds" : "pairs", kExactSignedRanks,
      holm ? "p (Holm): adjusted for all tests of the table.\n" : "");
  return out;
}

std::vector<Row> compare_rows(const Comparison& comparison, const std::string& where) {
  const DisplayScale any_scale;
  std::vector<Row> rows = group_table(comparison, any_scale, where).rows();
  std::vector<Row> pairs = pair_table(comparison, any_scale, where).rows();
  std::move(pairs.begin(), pairs.end(), std::back_inserter(rows));
  return rows;
}

}  // namespace palpate
