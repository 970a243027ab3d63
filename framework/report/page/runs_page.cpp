// SPDX-License-Identifier: MIT
#include "report/page/runs_page.hpp"

#include "config/display_units.hpp"
#include "record/build_info.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "report/page/json.hpp"
#include "report/page/page.hpp"
#include "report/page/run_page.hpp"
#include "report/words/titles.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

std::string letter_of(std::size_t run) { return std::string(1, static_cast<char>('A' + run)); }

/// Returns a table of the keys whose values differ between the configs, with the value in each run; "" for a run
/// without the key.
Table differences_table(const std::vector<ComparedRun>& runs) {
  std::vector<Row> configs;
  for (const ComparedRun& run : runs) configs.push_back(read_settings(run.recording.directory));
  Table table;
  for (const std::string& key : differing_keys(configs)) {
    table.add_row();
    table.show("key", key, Table::Kind::text);
    for (std::size_t i = 0; i < runs.size(); ++i) table.show(letter_of(i), configs[i].text(key), Table::Kind::text);
  }
  return table;
}

/// Returns a table with state and errors of each run. `described`: data of the runs, from run_data().
Table standings_table(const std::vector<ComparedRun>& runs, const Json& described) {
  std::vector<Row> errors;
  for (const ComparedRun& run : runs) {
    const RunResult& last = run.history.moments.back().result;
    add_errors(errors.emplace_back(), last.errors);
    errors.back().add(kExpectedError, Row{last.state.fields}.number(kExpectedError));
  }
  Table table;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto text = [&](const char* name) { return described[i].at(name).get<std::string>(); };
    const RunAtTap& last = runs[i].history.moments.back();
    table.add_row();
    table.show("run", fmt::format("{}: {} {}", letter_of(i), text("name"), text("id")), Table::Kind::text);
    table.show("seed", std::to_string(runs[i].recording.config.options.seed), Table::Kind::text);
    table.show("state", text("state") == "done" ? text("stop_reason") : text("state"), Table::Kind::text);
    table.show("taps", std::to_string(last.taps));
    table.show("robot time [s]", significant(last.result.robot_seconds, 4));
    for (const RecordField& error : page_errors()) {
      const auto has_value = [&](const Row& row) { return row.number(error.name).has_value(); };
      if (std::none_of(errors.begin(), errors.end(), has_value)) continue;
      const DisplayScale scale = usual_scale(error.unit);
      const auto value = errors[i].number(error.name);
      table.show(scale.title(error_title(error)), value ? significant(*value / scale.factor) : "–");
    }
  }
  return table;
}

}  // namespace

std::string runs_page(const std::vector<ComparedRun>& runs, const OnProgress& progress) {
  Json described;
  int most_taps = 0;
  for (const ComparedRun& run : runs) {
    described.push_back(run_data(run.recording, run.history));
    described.back()["directory"] = run.recording.directory.string();
    most_taps = std::max(most_taps, run.history.moments.back().taps);
  }
  Json data{{"version", kVersion},
            {"name", fmt::format("{} runs", runs.size())},
            {"id", "side by side"},
            {"errors", described.front()["errors"]},
            {"units", described.front()["units"]},
            {"standings", standings_table(runs, described)},
            {"differences", differences_table(runs)}};
  for (std::size_t stride = 1;; stride += 1 + stride / 4) {
    progress(most_taps, most_taps);
    std::string bytes;
    for (std::size_t i = 0; i < runs.size(); ++i) bytes += add_maps(described[i], runs[i].history, stride, "height");
    data["runs"] = described;
    std::string page = make_page(palpate_asset_runs, data, bytes);
    if (page.size() <= kMostPageBytes || stride > static_cast<std::size_t>(most_taps)) return page;
  }
}

}  // namespace palpate
