// SPDX-License-Identifier: MIT
#include "report/page/sweep_race.hpp"

#include "config/quantity.hpp"
#include "record/recorded_run.hpp"
#include "tune/race_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

/// Returns the position of a value on the axis of its key: the index in a list, or the number in the unit of the range.
/// Returns null for an option that the setting lacks.
Json position(const TunedKey& key, const std::string& text) {
  if (!key.range) {
    const auto same = [&](const Tree& one) { return value_text(one) == text; };
    const auto found = std::find_if(key.values.begin(), key.values.end(), same);
    return found != key.values.end() ? Json(found - key.values.begin()) : Json();
  }
  const auto value = any_quantity(text);
  const auto unit = any_quantity("1 " + key.range->unit);
  return value && unit ? Json(value->value / unit->value) : Json();
}

}  // namespace

Json json_of_race(const Sweep& sweep) {
  if (sweep.rounds.empty()) return {};
  const Tree config = read_run_config(sweep.directory);
  const TuneDescription description(config.find("tune"), {});
  const RaceRecord race = read_race(sweep, description);
  RaceValues values;
  read_results(sweep, description, values);
  const RaceOfPage words = race_of_page({sweep, description, race, values});
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
  for (std::size_t i = 0; i < race.settings.size(); ++i) {
    const RaceOfPage::Setting& one = words.settings[i];
    settings.push_back({{"jobs", race.settings[i].jobs},
                        {"words", one.words},
                        {"remark", one.remark},
                        {"lost", one.lost},
                        {"best", one.best},
                        {"at", Json::array()}});
    for (std::size_t key = 0; key < description.keys.size(); ++key)
      settings.back()["at"].push_back(position(description.keys[key], race.settings[i].values[key]));
  }
  return {{"metric", description.metric}, {"keys", keys}, {"settings", settings}, {"end", words.end}};
}

}  // namespace palpate
