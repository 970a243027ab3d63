// SPDX-License-Identifier: MIT
#include "report/page/sweep_race.hpp"

#include "record/recorded_run.hpp"
#include "tune/race_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

Json json_of_race(const Sweep& sweep) {
  if (sweep.rounds.empty()) return {};
  const Tree config = read_run_config(sweep.directory);
  const TuneDescription description(config.find("tune"), {});
  const RaceRecord race = read_race(sweep, description);
  RaceValues values;
  read_results(sweep, description, values);
  const RaceResults results(sweep, description, race, values);
  Json keys = Json::array();
  for (const TunedKey& one : description.keys) {
    keys.push_back({{"name", one.key}, {"unit", ""}, {"logarithmic", false}});
    if (one.range) {
      keys.back()["unit"] = one.range->unit;
      keys.back()["logarithmic"] = one.range->logarithmic;
      continue;
    }
    for (const Tree& value : one.values) keys.back()["texts"].push_back(value_text(value));
  }
  Json settings = Json::array();
  const std::vector<std::size_t>& racing = race.state.racing;
  for (std::size_t i = 0; i < race.settings.size(); ++i) {
    settings.push_back({{"jobs", race.settings[i].jobs},
                        {"words", settings_words(results, i)},
                        {"remark", remark_about(results, i)},
                        {"lost", !std::binary_search(racing.begin(), racing.end(), i)},
                        {"best", results.is_best(i)},
                        {"at", Json::array()}});
    for (std::size_t key = 0; key < description.keys.size(); ++key) {
      const auto position = description.keys[key].position(race.settings[i].values[key]);
      settings.back()["at"].push_back(position ? Json(*position) : Json());
    }
  }
  const std::string end =
      race.has_ended() ? fmt::format("The race ended because {}; {}.", race.end, fresh_words(results)) : "";
  return {{"metric", description.metric}, {"keys", keys}, {"settings", settings}, {"end", end}};
}

}  // namespace palpate
