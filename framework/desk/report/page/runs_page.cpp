// SPDX-License-Identifier: MIT
#include "report/page/runs_page.hpp"

#include "record/build_info.hpp"
#include "record/catalogue.hpp"
#include "report/page/json.hpp"
#include "report/page/page.hpp"
#include "report/page/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

/// Returns lines of a key and its value in each run; "" if a run lacks it.
Json json_of_differences(const std::vector<RunBeside>& runs) {
  std::vector<Row> configs;
  for (const RunBeside& run : runs) configs.push_back(read_settings(run.recording.directory));
  Json lines = Json::array();
  for (const std::string& key : differing_keys(configs)) {
    Json line{key};
    for (const Row& config : configs) line.push_back(config.text(key));
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

std::string runs_page(const std::vector<RunBeside>& runs, const OnProgress& progress) {
  Json described;
  int most_taps = 0;
  for (const RunBeside& run : runs) {
    described.push_back(run_data(run.recording, run.history));
    described.back()["directory"] = run.recording.directory.string();
    most_taps = std::max(most_taps, run.history.moments.back().taps);
  }
  Json data{{"version", kVersion},
            {"name", fmt::format("{} runs", runs.size())},
            {"id", "side by side"},
            {"errors", described.front()["errors"]},
            {"units", described.front()["units"]},
            {"differences", json_of_differences(runs)}};
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
