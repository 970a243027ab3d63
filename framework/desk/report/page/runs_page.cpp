// SPDX-License-Identifier: MIT
#include "report/page/runs_page.hpp"

#include "config/quantity.hpp"
#include "record/build_info.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "record/run_directory.hpp"
#include "report/page/json.hpp"
#include "report/page/page.hpp"
#include "report/page/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate {
namespace {

/// How good a run was at a moment, and what that had cost.
Json json_of_standing(const Moment& moment) {
  Row row;
  add_errors(row, moment.result.errors);
  row.add("taps", moment.taps);
  row.add("robot_seconds", moment.result.robot_seconds);
  row.add(kExpectedError, moment.result.expected_rmse);
  Json out = row;
  out["relabelled"] = Json::array();
  for (const Relabelled& one : moment.result.relabelled) out["relabelled"].push_back(one.tap);
  return out;
}

/// The series of that name; null if there is none.
const MapSeries* series(const History& history, const std::string& name) {
  const auto one = std::find_if(history.maps.begin(), history.maps.end(),
                                [&](const MapSeries& series) { return series.name == name; });
  return one != history.maps.end() ? &*one : nullptr;
}

/// Adds the surface at every stride-th moment that has maps, counted from the last, and the truth; `out` learns which
/// these are.
void pack_surfaces(const History& history, std::size_t stride, Json& out, std::string& bytes) {
  const std::size_t last = history.shown.size() - 1;
  std::vector<int> shown;
  std::vector<Eigen::VectorXf> heights;
  for (std::size_t i = last % stride; i <= last; i += stride) {
    shown.push_back(history.shown[i]);
    heights.push_back(series(history, "height")->frames[i]);
  }
  Json maps;
  const auto add = [&](const char* name, const std::vector<Eigen::VectorXf>& frames) {
    const PackedMaps packed = pack_maps(frames);
    maps.push_back({{"name", name}, {"least", packed.least}, {"most", packed.most}, {"frames", frames.size()}});
    bytes += packed.bytes;
  };
  add("height", heights);
  if (const MapSeries* truth = series(history, "truth")) add("truth", truth->frames);
  out["shown"] = shown;
  out["maps"] = maps;
}

Json json_of_run_beside(const RunBeside& run) {
  const ExperimentOptions& options = run.recording.config.options;
  const RunStatus status = read_status(run.recording.directory);
  Json moments;
  for (const Moment& moment : run.history.moments) moments.push_back(json_of_standing(moment));
  Json taps = Json::array();
  for (const Row& row : run.recording.rows) {
    Row mark;
    for (const char* name : {"tap", "x", "y", "height", "on_object", "outcome"}) {
      const Scalar* value = row.find(name);
      mark.add(name, value != nullptr ? *value : Scalar());
    }
    taps.push_back(mark);
  }
  return {{"name", options.name},
          {"id", run.recording.config.id},
          {"directory", run.recording.directory.string()},
          {"seed", options.seed},
          {"state", state_name(status.state)},
          {"stop_reason", status.stop_reason},
          {"width", options.scene.area.width},
          {"depth", options.scene.area.depth},
          {"x", std::vector<double>(run.history.x.begin(), run.history.x.end())},
          {"y", std::vector<double>(run.history.y.begin(), run.history.y.end())},
          {"moments", moments},
          {"taps", taps}};
}

/// Lines of a key and its value in each run, "" where it has none.
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
  Json errors = Json::array();
  int most_taps = 0;
  for (const RunBeside& run : runs) {
    described.push_back(json_of_run_beside(run));
    most_taps = std::max(most_taps, run.history.moments.back().taps);
  }
  for (const RecordField& error : page_errors()) errors.push_back({error.name, error.label, unit_symbol(error.unit)});
  Json data{{"version", kVersion},
            {"name", fmt::format("{} runs", runs.size())},
            {"id", "side by side"},
            {"errors", errors},
            {"differences", json_of_differences(runs)}};
  for (std::size_t stride = 1;; stride += 1 + stride / 4) {
    progress(most_taps, most_taps);
    std::string bytes;
    for (std::size_t i = 0; i < runs.size(); ++i) pack_surfaces(runs[i].history, stride, described[i], bytes);
    data["runs"] = described;
    std::string page = make_page(palpate_asset_runs, data, bytes);
    if (page.size() <= kMostPageBytes || stride > static_cast<std::size_t>(most_taps)) return page;
  }
}

}  // namespace palpate
