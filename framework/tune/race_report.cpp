// SPDX-License-Identifier: MIT
#include "tune/race_report.hpp"

#include "analysis/bootstrap.hpp"
#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/table.hpp"
#include "config/yaml.hpp"
#include "record/fields.hpp"
#include "record/recorded_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace palpate {
namespace {

constexpr std::size_t kMostRows = 10;

const Loser* loss_of(const RaceRecord& race, std::size_t setting) {
  for (const Loser& one : race.losers) {
    if (one.row == setting) return &one;
  }
  return nullptr;
}

/// Returns all settings: the winner, the others in the race by their means, then those that left, the last one first.
std::vector<std::size_t> listed_settings(const RaceResults& results) {
  const RaceRecord& race = results.race;
  std::vector<std::size_t> out(race.settings.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  const auto key = [&](std::size_t setting) {
    const bool wins = std::count(race.front.begin(), race.front.end(), setting) > 0;
    const bool races = std::count(race.state.racing.begin(), race.state.racing.end(), setting) > 0;
    // Settings with fewer seeds left earlier.
    return std::make_tuple(!wins, !races, races ? 0 : race.race_jobs - race.settings[setting].jobs.size(),
                           results.description.more_is_better ? -results.means[setting] : results.means[setting]);
  };
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return out;
}

/// Returns the values, with the worst one in place of missing ones.
std::vector<double> filled(const std::vector<std::optional<double>>& values) {
  std::optional<double> worst;
  for (const std::optional<double>& one : values) worst = std::max(worst, one);
  std::vector<double> out;
  for (const std::optional<double>& one : values) out.push_back(one.value_or(worst.value_or(0.0)));
  return out;
}

/// Returns the mean of a field over the fresh seeds of a setting, with its interval.
MeanEstimate fresh_mean(const RacedSetting& setting, const std::vector<double>& values, double sign) {
  Clusters out;
  for (const std::size_t job : setting.fresh) out.push_back({sign * values[job]});
  return out.empty() ? MeanEstimate{} : mean_of_sample(out);
}

/// Returns a table of the settings on the front, the cheapest last, and of the config as it stands, on the fresh seeds.
std::string front_text(const RaceResults& results) {
  const RaceRecord& race = results.race;
  std::vector<std::size_t> settings = race.front;
  if (std::count(settings.begin(), settings.end(), std::size_t{0}) == 0) settings.push_back(0);
  const std::vector<double> metric = filled(results.values.metric);
  const std::vector<double> cost = filled(results.values.cost);
  std::vector<std::vector<MeanEstimate>> means(2);
  for (const std::size_t one : settings) {
    means[0].push_back(fresh_mean(race.settings[one], metric, results.description.more_is_better ? -1 : 1));
    means[1].push_back(fresh_mean(race.settings[one], cost, 1));
  }
  Table table;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    table.add_row();
    table.show("on fresh seeds", settings_words(results, settings[i]), Table::Kind::text);
    for (const bool is_cost : {false, true}) {
      const std::string& field = is_cost ? *results.description.cost : results.description.metric;
      std::vector<double> all;
      for (const MeanEstimate& one : means[is_cost]) all.push_back(one.mean);
      const DisplayScale scale = readable_scale(unit_of_column(field), all);
      table.show(scale.title(field), scale.estimate(means[is_cost][i]));
    }
    table.show("", settings[i] == 0 ? "config as it stands" : "", Table::Kind::text);
  }
  return table.text();
}

}  // namespace

std::string settings_words(const RaceResults& results, std::size_t setting) {
  std::vector<std::string> out;
  const std::vector<std::string>& values = results.race.settings[setting].values;
  for (std::size_t key = 0; key < values.size(); ++key) {
    if (!values[key].empty()) out.push_back(fmt::format("{}={}", results.description.keys[key].key, values[key]));
  }
  return fmt::format("{}", fmt::join(out, " "));
}

std::string remark_about(const RaceResults& results, std::size_t setting) {
  std::vector<std::string> out;
  if (setting == 0) out.emplace_back("config as it stands");
  if (results.is_best(setting)) out.emplace_back(results.description.cost ? "on the front" : "best");
  // On a front, the difference may be one of the cost, which has another unit.
  if (const Loser* loss = loss_of(results.race, setting))
    out.push_back(fmt::format("lost after {} seeds: {}p {:.2g}", loss->seeds,
                              results.description.cost ? "" : results.scale.quantity(loss->difference) + " worse, ",
                              loss->p));
  if (const std::size_t stage = results.race.settings[setting].left_out_of; stage > 0)
    out.push_back(fmt::format("not taken into stage {}", stage));
  return fmt::format("{}", fmt::join(out, ", "));
}

std::string fresh_words(const RaceResults& results) {
  const std::size_t front = results.race.front.size();
  if (results.description.cost)
    return fmt::format("{} setting{} on the front of {} and {}", front, front == 1 ? " is" : "s are",
                       results.description.metric, *results.description.cost);
  if (results.race.front.front() == 0) return "the config as it stands is the best setting";
  if (results.values.unfinished > 0) return "the runs on fresh seeds have not ended";
  const MeanEstimate& gain = results.gain;
  if (gain.count == 0) return "no fresh seeds were run";
  std::string words =
      fmt::format("gain over the config as it stands, on {} that had no part in the choice: {}",
                  units_words(gain.clusters, true), results.scale.with_unit(results.scale.estimate(gain)));
  if (results.best.front() == 0)
    words += "; the config as it stands is better and stays the best";
  else if (gain.interval && gain.interval->low <= 0.0)
    words += "; the interval contains 0, so the gain is not certain";
  return words;
}

RaceResults::RaceResults(const Sweep& race_sweep, const TuneDescription& tuned, const RaceRecord& record,
                         const RaceValues& race_values)
    : sweep(race_sweep),
      description(tuned),
      race(record),
      values(race_values),
      means(means_of(race_table(record, race_values.metric))),
      best(record.front) {
  for (double& one : means) one = description.more_is_better ? -one : one;
  scale = readable_scale(unit_of_column(description.metric), means);
  if (!race.has_ended() || description.cost || values.unfinished > 0) return;
  const std::vector<std::size_t>& own = race.settings[0].fresh;
  const std::vector<std::size_t>& other = race.settings[race.front.front()].fresh;
  const std::vector<double> metric = filled(values.metric);
  Clusters gains;
  for (std::size_t i = 0; i < std::min(own.size(), other.size()); ++i)
    gains.push_back({metric[own[i]] - metric[other[i]]});
  if (!gains.empty()) gain = mean_of_sample(gains);
  if (gain.interval && gain.interval->high < 0.0) best = {0};
}

bool RaceResults::is_best(std::size_t setting) const { return std::count(best.begin(), best.end(), setting) > 0; }

std::vector<Row> race_rows(const RaceResults& results) {
  std::vector<Row> out;
  for (std::size_t setting = 0; setting < results.race.settings.size(); ++setting) {
    const RacedSetting& one = results.race.settings[setting];
    Row& row = out.emplace_back();
    row.add("setting", static_cast<std::int64_t>(setting));
    for (std::size_t key = 0; key < one.values.size(); ++key)
      row.add(results.description.keys[key].key, one.values[key]);
    row.add("seeds", static_cast<std::int64_t>(one.jobs.size()));
    row.add(results.description.metric, results.means[setting]);
    const Loser* loss = loss_of(results.race, setting);
    const std::size_t left = loss != nullptr ? loss->seeds : one.left_out_of > 0 ? one.jobs.size() : 0;
    row.add("lost_after_seeds", left > 0 ? std::optional(static_cast<std::int64_t>(left)) : std::nullopt);
    row.add("difference",
            loss != nullptr && !results.description.cost ? std::optional(loss->difference) : std::nullopt);
    row.add("p", loss != nullptr ? std::optional(loss->p) : std::nullopt);
    row.add("is_best", results.is_best(setting));
    const std::vector<std::size_t>& front = results.race.front;
    const MeanEstimate gain = !front.empty() && setting == front.front() ? results.gain : MeanEstimate{};
    row.add("fresh_seeds", static_cast<std::int64_t>(gain.clusters));
    row.add("gain", gain.count > 0 ? std::optional(gain.mean) : std::nullopt);
    add_interval(row, "gain_", gain.interval);
  }
  return out;
}

std::string race_text(const RaceResults& results) {
  const RaceRecord& race = results.race;
  Table table;
  const std::vector<std::size_t> listed = listed_settings(results);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    if (i >= kMostRows && listed[i] != 0) continue;
    const RacedSetting& one = race.settings[listed[i]];
    table.add_row();
    const std::vector<std::string> values = shown_values(one.values);
    for (std::size_t key = 0; key < values.size(); ++key)
      table.show(results.description.keys[key].key, values[key], Table::Kind::text);
    table.show("seeds", std::to_string(one.jobs.size()));
    table.show(results.scale.title(results.description.metric), results.scale.number(results.means[listed[i]]));
    table.show("", remark_about(results, listed[i]), Table::Kind::text);
  }
  std::string out = table.text();
  if (listed.size() > kMostRows) out += fmt::format("{} settings in all: race.csv\n", listed.size());
  out += fmt::format("{} runs; the race ended because {}\n", race.race_jobs, race.end);
  const auto missing = std::count(results.values.metric.begin(), results.values.metric.end(), std::nullopt);
  if (missing > 0) out += fmt::format("{} runs failed or have no value; they count as the worst result\n", missing);
  if (results.description.cost) out += front_text(results);
  return out + fresh_words(results) + "\n";
}

std::string config_of_setting(const RaceResults& results, std::size_t setting) {
  const RaceRecord& race = results.race;
  const Job& first = results.sweep.jobs[race.settings[setting].jobs.front()];
  Tree config = read_run_config(job_directory(results.sweep, first));
  config.erase("expect");
  // Sweeps record no surfaces unless their config demands it.
  if (read_run_config(results.sweep.directory).find_path("log.surface") == nullptr) config.erase_path("log.surface");
  // With a new name, the run gets a folder runs/NAME of its own.
  Tree& name = config.at("name");
  name = Tree::scalar(name.text + "_best", true);
  std::string comment = fmt::format("{} {} settings: {}\n", results.description.cost ? "On the front of" : "Best of",
                                    race.settings.size(), settings_words(results, setting));
  for (const TunedKey& one : results.description.keys)
    comment += fmt::format("tried: {}={}\n", one.key, value_text(one.written));
  comment += fmt::format("metric: {}; {} runs; {}\n{}", results.description.metric, race.race_jobs, race.end,
                         fresh_words(results));
  return "# " + boost::replace_all_copy(comment, "\n", "\n# ") + "\n" + to_yaml(config);
}

}  // namespace palpate
