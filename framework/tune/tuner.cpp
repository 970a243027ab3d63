// SPDX-License-Identifier: MIT
#include "tune/tuner.hpp"

#include "analysis/column.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "sweep/read_jobs.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLeastBudget = 60;  ///< of a search: six settings on four seeds, and the stages after them
constexpr std::size_t kMostBudget = std::size_t{1} << 40;
constexpr std::size_t kDrawsPerSetting = 20;

Row round_row(const RaceDecision& decision, std::optional<double> seconds) {
  Row row;
  const RaceState& state = decision.state;
  row.add("stage", static_cast<std::int64_t>(state.stage));
  row.add("budget", static_cast<std::int64_t>(state.budget));
  row.add("stage_end", static_cast<std::int64_t>(state.stage_end));
  row.add("seeds", static_cast<std::int64_t>(state.seeds));
  row.add("racing", JsonList{fmt::format("[{}]", fmt::join(state.racing, ", "))});
  std::vector<Row> dropped;
  for (const Loser& one : decision.losers) {
    Row& loser = dropped.emplace_back();
    loser.add("setting", static_cast<std::int64_t>(one.row));
    loser.add("seeds", static_cast<std::int64_t>(one.seeds));
    loser.add("difference", one.difference);
    loser.add("p", one.p);
  }
  row.add("dropped", list_of(dropped));
  if (seconds) row.add("seconds", *seconds);
  if (decision.end.empty()) return row;
  row.add("end", decision.end);
  row.add("front", JsonList{fmt::format("[{}]", fmt::join(decision.front, ", "))});
  return row;
}

Error damaged(const Sweep& sweep, const char* field) {
  return {(sweep.directory / "manifest.jsonl").string(), fmt::format("a round has no valid '{}'", field),
          "the file is damaged: put it back as it was"};
}

/// Returns a number of the field `name` of a round. Throws Error if it is missing, negative, or not below `limit`.
std::size_t whole(std::optional<double> value, const char* name, std::size_t limit, const Sweep& sweep) {
  if (value && *value >= 0.0 && *value < static_cast<double>(limit)) return static_cast<std::size_t>(*value);
  throw damaged(sweep, name);
}

std::size_t whole(const Row& row, const char* name, std::size_t limit, const Sweep& sweep) {
  return whole(row.number(name), name, limit, sweep);
}

JsonList list_in(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  return value != nullptr && std::holds_alternative<JsonList>(*value) ? std::get<JsonList>(*value) : JsonList{"[]"};
}

/// Returns the numbers in a list such as [0, 3, 7].
std::vector<std::size_t> numbers_in(const Row& row, const char* name, std::size_t limit, const Sweep& sweep) {
  std::vector<std::size_t> out;
  const Tree tree = parse_json(fmt::format("{{\"list\": {}}}", list_in(row, name).text), sweep.directory);
  for (const Tree& item : tree.find("list")->items)
    out.push_back(whole(std::atof(item.text.c_str()), name, limit, sweep));
  return out;
}

/// Returns the values of the tuned keys, which are the last ones before the seed.
std::vector<std::string> tuned_values(const Job& job, std::size_t keys) {
  const auto end = job.values.end() - 1;
  return {end - static_cast<std::ptrdiff_t>(keys), end};
}

/// Returns the value of a setting at a tuned key for a further job, from its recorded text.
std::optional<Tree> value_of_text(const TunePlanner& planner, std::size_t key, const std::string& text) {
  const TunedKey& tuned = planner.description().keys[key];
  if (text.empty()) return std::nullopt;  // The plugins of this setting lack the option.
  if (!tuned.range) {
    const auto coordinate = planner.space().coordinate(key, text);
    return coordinate ? std::optional(planner.space().value(key, *coordinate)) : std::nullopt;
  }
  Tree value = tuned.written;
  value.text = text;
  value.quoted = false;
  return value;
}

SettingValues values_of_setting(const TunePlanner& planner, const RaceRecord& race, std::size_t setting) {
  SettingValues out(planner.description().keys.size());
  if (setting == 0) return out;  // the config as it stands
  for (std::size_t key = 0; key < out.size(); ++key)
    out[key] = value_of_text(planner, key, race.settings[setting].values[key]);
  return out;
}

/// Returns the point of a setting. A value outside of the space, or of an option that the setting lacks, is drawn.
Point point_of_setting(const TunePlanner& planner, const RacedSetting& setting, Random& random) {
  Point out;
  for (std::size_t key = 0; key < setting.values.size(); ++key) {
    const TunedKey& tuned = planner.description().keys[key];
    const auto coordinate = planner.space().coordinate(key, setting.values[key]);
    const double drawn = tuned.range ? random.uniform() : static_cast<double>(random.index(tuned.values.size()));
    out.push_back(coordinate.value_or(drawn));
  }
  return out;
}

/// Returns the values as Job::values has them, if the plugins have all options.
std::vector<std::string> texts_of(const SettingValues& values) {
  std::vector<std::string> out;
  for (const std::optional<Tree>& one : values) out.push_back(one ? value_text(*one) : "");
  return out;
}

/// Draws settings near the elites. Better elites are drawn more often.
std::vector<SettingValues> draw_settings(const TunePlanner& planner, const RaceRecord& race,
                                         const RaceDecision& decision, std::size_t round) {
  Random random(0, "tune.join", round);
  std::set<std::vector<std::string>> seen;
  for (const RacedSetting& one : race.settings) seen.insert(one.values);
  // Weights 5, 4, 3, 2, 1: each elite occurs this many times.
  std::vector<std::size_t> parents;
  for (std::size_t rank = 0; rank < decision.elites.size(); ++rank)
    parents.insert(parents.end(), decision.elites.size() - rank, decision.elites[rank]);
  std::vector<SettingValues> out;
  for (std::size_t draw = 0; draw < kDrawsPerSetting * decision.new_settings && out.size() < decision.new_settings;
       ++draw) {
    const RacedSetting& parent = race.settings[parents[random.index(parents.size())]];
    const Point near = planner.space().near(point_of_setting(planner, parent, random), decision.spread, random);
    SettingValues values = planner.values_at(near);
    if (planner.is_wanted(values) && seen.insert(texts_of(values)).second) out.push_back(std::move(values));
  }
  return out;
}

/// Plans a recorded job of a setting again. Throws Error if its id has changed; `sink` is then called, too.
void plan_again(const TunePlanner& planner, const Sweep& sweep, const RaceRecord& race, std::size_t setting,
                const Job& recorded, const JobSink& sink) {
  const auto seed = static_cast<std::size_t>(std::atoll(recorded.values.back().c_str()) - planner.own().options.seed);
  const PlannedSetting planned{values_of_setting(planner, race, setting), seed, seed + 1};
  if (planner.plan({planned}, 0, false, sink).front().id == recorded.id) return;
  throw Error(sweep.directory.string(),
              "the config groups, the files or the plugins of this race were changed since it began",
              "restore them, or begin a new race with 'palpate tune'");
}

/// Throws Error unless the first jobs of these settings would be planned as they are recorded.
void check_unchanged(const TunePlanner& planner, const Sweep& sweep, const RaceRecord& race,
                     const std::vector<std::size_t>& settings) {
  for (const std::size_t one : settings)
    plan_again(planner, sweep, race, one, sweep.jobs[race.settings[one].jobs.front()],
               [](const Job&, const ResolvedConfig&) {});
}

/// Writes the config of a job, unless it exists.
void write_job(const Sweep& sweep, const Job& job, const ResolvedConfig& config) {
  const fs::path directory = sweep.directory / "jobs" / job.id;
  if (is_there(directory / "config.yaml")) return;
  refuse_link(directory.parent_path());
  make_inner_folder(directory);
  write_file(directory / "config.yaml", to_yaml_with_places(config.tree));
}

/// Returns the settings that run on fresh seeds: those on the front, and the config as it stands.
std::vector<std::size_t> compared_settings(const RaceDecision& decision) {
  std::vector<std::size_t> out = decision.front;
  if (std::count(out.begin(), out.end(), std::size_t{0}) == 0) out.push_back(0);
  return out;
}

/// Returns the settings and seeds of the next round.
std::vector<PlannedSetting> settings_of_round(const TunePlanner& planner, const RaceRecord& race,
                                              const RaceDecision& decision, std::size_t round) {
  std::vector<PlannedSetting> out;
  if (!decision.end.empty()) {
    const std::size_t fresh = planner.description().fresh;
    const std::vector<std::size_t> compared = compared_settings(decision);
    if (compared.size() == 1 || fresh == 0) return out;
    std::size_t used = 0;
    for (const RacedSetting& one : race.settings) used = std::max(used, one.jobs.size());
    for (const std::size_t one : compared) out.push_back({values_of_setting(planner, race, one), used, used + fresh});
    return out;
  }
  for (const std::size_t one : decision.state.racing) {
    const std::size_t has = race.settings[one].jobs.size();
    if (has < decision.state.seeds) out.push_back({values_of_setting(planner, race, one), has, decision.state.seeds});
  }
  if (decision.new_settings == 0) return out;
  for (SettingValues& values : draw_settings(planner, race, decision, round))
    out.push_back({std::move(values), 0, kFirstSeeds});
  return out;
}

/// Returns the number of settings among new jobs that the race does not have yet.
std::size_t count_new_settings(const RaceRecord& race, const std::vector<Job>& jobs, std::size_t keys) {
  std::set<std::vector<std::string>> known;
  for (const RacedSetting& one : race.settings) known.insert(one.values);
  const std::size_t before = known.size();
  for (const Job& job : jobs) known.insert(tuned_values(job, keys));
  return known.size() - before;
}

/// Throws Error if most runs have no value of the metric.
void check_values(const std::vector<std::optional<double>>& results, const std::string& field, const Sweep& sweep) {
  const auto missing = std::count(results.begin(), results.end(), std::nullopt);
  if (2 * static_cast<std::size_t>(missing) <= results.size()) return;
  throw Error(sweep.directory.string(),
              fmt::format("{} of {} runs have no value of '{}'", missing, results.size(), field),
              "see 'palpate compare' for the reasons, or tune another metric");
}

/// Throws Error unless the state of a race fits its settings.
void check_state(const RaceRecord& race, const Sweep& sweep) {
  const std::vector<std::size_t>& racing = race.state.racing;
  if (racing.empty() || !std::is_sorted(racing.begin(), racing.end()) ||
      std::adjacent_find(racing.begin(), racing.end()) != racing.end())
    throw damaged(sweep, "racing");
  for (const std::size_t one : racing) {
    if (race.state.seeds < kFirstSeeds || race.settings[one].jobs.size() < race.state.seeds)
      throw damaged(sweep, "seeds");
  }
}

}  // namespace

RaceRecord read_race(const Sweep& sweep, const TuneDescription& description) {
  RaceRecord out;
  if (sweep.rounds.empty())
    throw Error(sweep.directory.string(), "is not the directory of a race", "it was not made by 'palpate tune'");
  const std::size_t keys = description.keys.size();
  if (sweep.keys.size() <= keys)
    throw Error(sweep.directory.string(), "has fewer keys than its config tunes", "the files are damaged");
  std::map<std::vector<std::string>, std::size_t> numbers;
  std::size_t next = 0;
  for (const SweepRound& round : sweep.rounds) {
    const bool is_fresh = round.decision.find("end") != nullptr;
    if (is_fresh && &round != &sweep.rounds.back()) throw damaged(sweep, "end");
    for (; next < round.jobs; ++next) {
      const std::vector<std::string> values = tuned_values(sweep.jobs[next], keys);
      const auto [number, is_new] = numbers.emplace(values, out.settings.size());
      if (is_new) out.settings.push_back({values, {}, {}, 0});
      RacedSetting& setting = out.settings[number->second];
      (is_fresh ? setting.fresh : setting.jobs).push_back(next);
    }
    if (!is_fresh) out.race_jobs = next;
    const std::size_t all = out.settings.size();
    std::vector<bool> races(all);
    for (const std::size_t one : numbers_in(round.decision, "racing", all, sweep)) races[one] = true;
    for (const Row& one : rows_of(list_in(round.decision, "dropped")))
      out.losers.push_back({whole(one, "setting", all, sweep), whole(one, "seeds", next + 1, sweep),
                            one.number("difference").value_or(0.0), one.number("p").value_or(0.0)});
    for (const Loser& one : out.losers) races[one.row] = true;
    for (std::size_t one = 0; one < all; ++one) {
      if (!races[one] && out.settings[one].left_out_of == 0)
        out.settings[one].left_out_of = whole(round.decision, "stage", kLastStage + 1, sweep);
    }
  }
  const Row& last = sweep.rounds.back().decision;
  const std::size_t all = out.settings.size();
  out.state = {whole(last, "stage", kLastStage + 1, sweep), whole(last, "budget", kMostBudget, sweep),
               whole(last, "stage_end", kMostBudget, sweep), whole(last, "seeds", sweep.jobs.size() + 1, sweep),
               numbers_in(last, "racing", all, sweep)};
  check_state(out, sweep);
  out.seconds = last.number("seconds").value_or(0.0);
  out.end = last.text("end");
  if (!out.has_ended()) return out;
  out.front = numbers_in(last, "front", all, sweep);
  for (const std::size_t one : out.front) {
    if (out.settings[one].jobs.empty()) throw damaged(sweep, "front");
  }
  if (out.front.empty()) throw damaged(sweep, "front");
  return out;
}

void replace_lost(const TunePlanner& planner, const Sweep& sweep, const RaceRecord& race) {
  for (std::size_t setting = 0; setting < race.settings.size(); ++setting) {
    std::vector<std::size_t> jobs = race.settings[setting].jobs;
    jobs.insert(jobs.end(), race.settings[setting].fresh.begin(), race.settings[setting].fresh.end());
    for (const std::size_t job : jobs) {
      const Job& recorded = sweep.jobs[job];
      if (is_there(job_directory(sweep, recorded) / "config.yaml")) continue;
      plan_again(planner, sweep, race, setting, recorded, [&](const Job& again, const ResolvedConfig& config) {
        if (again.id == recorded.id) write_job(sweep, again, config);
      });
    }
  }
}

void read_results(const Sweep& sweep, const TuneDescription& description, RaceValues& out) {
  std::vector<std::size_t> next = all_jobs(sweep);
  next.erase(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(out.metric.size()));
  const auto value_of = [](const std::optional<Row>& row, const std::string& field) -> std::optional<double> {
    const JobValue value = value_of_job(row ? &*row : nullptr, field, "--metric");
    return value.status == ValueStatus::counted ? std::optional(value.value) : std::nullopt;
  };
  read_jobs(sweep, next, read_outcome, [&](std::size_t, const std::optional<Row>& row) {
    out.unfinished += row ? 0 : 1;
    std::optional<double> value = value_of(row, description.metric);
    if (value && description.more_is_better) value = -*value;
    out.metric.push_back(value);
    if (description.cost) out.cost.push_back(value_of(row, *description.cost));
  });
}

RaceTable race_table(const RaceRecord& race, const std::vector<std::optional<double>>& results) {
  std::optional<double> worst;
  for (const RacedSetting& one : race.settings) {
    for (const std::size_t job : one.jobs) {
      if (results[job]) worst = std::max(worst.value_or(*results[job]), *results[job]);
    }
  }
  RaceTable out;
  for (const RacedSetting& one : race.settings) {
    std::vector<double>& row = out.emplace_back();
    for (const std::size_t job : one.jobs) row.push_back(results[job].value_or(worst.value_or(0.0)));
  }
  return out;
}

SweepPlan plan_first_round(const TunePlanner& planner, std::size_t budget, const fs::path& runs, const JobSink& sink) {
  const SearchSpace& space = planner.space();
  const bool is_search = !space.is_finite();
  if (is_search && budget < kLeastBudget)
    throw Error("tune", fmt::format("{} jobs are too few for a search in continuous ranges", budget),
                fmt::format("give at least {}, more time, or lists of values", kLeastBudget));
  std::vector<PlannedSetting> settings{{SettingValues(planner.description().keys.size()), 0, kFirstSeeds}};
  const std::size_t most = initial_settings(budget);
  for (const Point& point : is_search ? space.sobol(kDrawsPerSetting * most) : space.grid()) {
    if (is_search && settings.size() == most) break;
    SettingValues values = planner.values_at(point);
    if (planner.is_wanted(values)) settings.push_back({std::move(values), 0, kFirstSeeds});
  }
  const std::string place = planner.description().written.find("keys")->place.text();
  // Settings that are equal to others are left out below, but never more than all but one.
  if (settings.size() > budget)
    throw Error("tune", fmt::format("{} jobs are fewer than the {} settings", budget, settings.size()),
                "give more jobs or more time, or fewer values");
  SweepPlan plan{{{}, planner.keys(), planner.plan(settings, 0, true, sink)}, planner.written()};
  check_readable(plan.config, planner.own().options.name);
  if (plan.sweep.jobs.size() > budget)
    throw Error("tune",
                fmt::format("{} jobs are fewer than the first round needs: {} settings on {} seeds", budget,
                            plan.sweep.jobs.size() / kFirstSeeds, kFirstSeeds),
                fmt::format("give at least {}, more time, or fewer values", plan.sweep.jobs.size()));
  if (plan.sweep.jobs.size() == kFirstSeeds)
    throw Error(place, "tune: no setting differs from the config as it stands",
                "give other values, or a condition that some of them fulfil");
  std::set<std::vector<std::string>> values;
  for (const Job& job : plan.sweep.jobs) values.insert(tuned_values(job, planner.description().keys.size()));
  if (values.size() * kFirstSeeds != plan.sweep.jobs.size())
    throw Error(place, "tune: two settings have the same type, but different options",
                "name the group that the config itself has in the list");
  RaceDecision decision;
  decision.state.budget = budget;
  decision.state.stage_end = first_stage_end({is_search, 0.0}, budget);
  for (std::size_t i = 0; i < plan.sweep.jobs.size() / kFirstSeeds; ++i) decision.state.racing.push_back(i);
  plan.sweep.rounds.push_back({plan.sweep.jobs.size(), round_row(decision, std::nullopt)});
  plan.sweep.directory = race_directory(planner, runs);
  return plan;
}

fs::path race_directory(const TunePlanner& planner, const fs::path& runs) {
  Sweep sweep;
  sweep.rounds.emplace_back();  // The id of a sweep with rounds depends on its config only.
  return runs / slug(planner.own().options.name) / sweep_id(planner.written(), sweep);
}

bool add_round(const TunePlanner& planner, const fs::path& directory, std::size_t rounds, std::size_t budget,
               double seconds, RaceValues& results) {
  const TuneDescription& description = planner.description();
  const FileLock lock = FileLock::wait_for(directory / "lock");
  const Sweep sweep = read_sweep(directory);
  if (sweep.rounds.size() != rounds) return true;  // Another process has added a round; its jobs may not have ended.
  RaceRecord race = read_race(sweep, description);
  read_results(sweep, description, results);
  if (race.has_ended()) return false;
  check_values(results.metric, description.metric, sweep);
  if (description.cost) check_values(results.cost, *description.cost, sweep);
  const RaceTable table = race_table(race, results.metric);
  const RaceTable costs = description.cost ? race_table(race, results.cost) : RaceTable();
  const RaceRules rules{!planner.space().is_finite(), description.within};
  std::set<std::string> known;
  for (const Job& job : sweep.jobs) known.insert(job.id);
  std::vector<Loser> losers;
  for (;;) {
    RaceDecision decision =
        decide(rules, race.state, table, description.cost ? &costs : nullptr, budget, race.race_jobs);
    check_unchanged(planner, sweep, race, decision.end.empty() ? decision.state.racing : compared_settings(decision));
    const std::vector<PlannedSetting> settings = settings_of_round(planner, race, decision, sweep.rounds.size());
    std::vector<Job> jobs;
    if (!settings.empty()) {
      jobs = planner.plan(settings, sweep.jobs.size(), false, [&](const Job& job, const ResolvedConfig& config) {
        if (known.count(job.id) == 0) write_job(sweep, job, config);
      });
    }
    // A setting may be equal to an earlier one although its values are written differently.
    jobs.erase(std::remove_if(jobs.begin(), jobs.end(), [&](const Job& job) { return known.count(job.id) > 0; }),
               jobs.end());
    for (std::size_t i = 0; i < jobs.size(); ++i) jobs[i].index = static_cast<int>(sweep.jobs.size() + i);
    if (decision.end.empty()) {
      const std::size_t joined = count_new_settings(race, jobs, description.keys.size());
      for (std::size_t i = 0; i < joined; ++i) decision.state.racing.push_back(race.settings.size() + i);
    }
    losers.insert(losers.end(), decision.losers.begin(), decision.losers.end());
    if (jobs.empty() && decision.end.empty()) {
      race.state = decision.state;  // No setting could join: the next stage begins.
      continue;
    }
    decision.losers = losers;
    // The decisions of a race with a budget in runs do not depend on time, so its manifest has no times.
    append_round(sweep, jobs, round_row(decision, description.seconds ? std::optional(seconds) : std::nullopt));
    return true;
  }
}

}  // namespace palpate
