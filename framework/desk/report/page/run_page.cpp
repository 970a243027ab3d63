// SPDX-License-Identifier: MIT
#include "report/page/run_page.hpp"

#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "record/build_info.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "record/tap_row.hpp"
#include "report/curves.hpp"
#include "report/page/assets.hpp"
#include "report/page/json_text.hpp"
#include "report/page/page.hpp"
#include "report/page/warnings.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <unordered_map>

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string json_of_run(const Recording& recording) {
  const ExperimentOptions& options = recording.config.options;
  Row row;
  row.add("name", options.name);
  row.add("id", recording.config.id);
  row.add("seed", options.seed);
  const RunStatus status = read_status(recording.directory);
  row.add("state", state_name(status.state));
  row.add("stop_reason", status.stop_reason);
  row.add("budget", options.taps);
  row.add("acquisition", options.acquisition.type);
  row.add("footprint", options.footprint.type);
  row.add("width", options.scene.area.width);
  row.add("depth", options.scene.area.depth);
  row.add("desk", options.scene.desk);
  row.add("truth", recording.truth_known());
  return to_json_line(row);
}

std::string json_of_moment(const Moment& moment) {
  const RunResult& result = moment.result;
  Row row;
  row.add("taps", moment.taps);
  row.add("on_surface_taps", result.on_surface_taps);
  row.add("off_surface_taps", result.off_surface_taps);
  row.add("failed_taps", result.failed_taps);
  row.add("robot_seconds", result.robot_seconds);
  add_errors(row, result.errors);
  row.add("least_weight", moment.least_weight);
  row.add("most_weight", moment.most_weight);
  if (result.footprint) row.add("remark", result.footprint->remark);
  if (moment.next) {
    row.add("next.x", moment.next->target.x);
    row.add("next.y", moment.next->target.y);
    row.add("next.source", source_name(moment.next->source));
    row.add("next.why", moment.next->why);
    row.add("next.score", moment.next->score);
    row.add("next.ties", moment.next->ties);
  }
  return to_json_line(row);
}

/// A line of a panel, as run_curves.js draws it.
std::string json_of_curve(const Curve& curve) {
  return json_object(
      {{"name", json_quoted(curve.name)}, {"values", json_list_of(curve.values, [](const std::optional<double>& value) {
                                             return value ? json_value(*value) : std::string("null");
                                           })}});
}

std::string json_of_panel(const CurvePanel& panel) {
  constexpr const char* kAxes[] = {"free", "from_zero", "share", "logarithmic"};  // by CurveAxis
  return json_object({{"title", json_quoted(panel.title)},
                      {"unit", json_quoted(panel.unit)},
                      {"axis", json_quoted(kAxes[static_cast<std::size_t>(panel.axis)])},
                      {"curves", json_list_of(panel.curves, json_of_curve)}});
}

/// How a page calls the errors, and in what unit it has them.
std::string json_of_error(const RecordField& field) {
  return json_texts({field.name, field.label, unit_symbol(field.unit)});
}

std::string text_of(const Tree& tree) {
  std::string text = to_yaml(tree);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// The config as lines of path, value and origin: that of the manifest, which knows the files behind config.yaml.
std::string json_of_config(const Recording& recording, const Tree& manifest) {
  std::unordered_map<std::string, std::string> known;
  if (const Tree* origins = manifest.find("origins")) {
    for (const Tree::Entry& entry : origins->entries) known.emplace(entry.key, entry.value.text);
  }
  std::vector<std::string> lines;
  for (const ResolveNotes::Origin& one : recording.config.notes.origins) {
    const auto place = known.find(one.path);
    lines.push_back(json_texts({one.path, text_of(*recording.config.tree.find_path(one.path)),
                                place != known.end() ? place->second : one.place}));
  }
  return json_list(lines);
}

std::string json_of_build(const Tree& manifest) {
  std::vector<std::string> lines;
  for (const char* key : {"version", "commit", "dirty", "compiler", "instruction_path", "host"}) {
    if (const Tree* value = manifest.find(key)) lines.push_back(json_texts({key, value->text}));
  }
  if (const Tree* line = manifest.find("command_line")) {
    std::string words;
    for (const Tree& word : line->items) words += (words.empty() ? "" : " ") + word.text;
    lines.push_back(json_texts({"command line", words}));
  }
  return json_list(lines);
}

/// The maps of every `stride`-th moment, counted from the last.
std::vector<MapSeries> thinned(const std::vector<MapSeries>& maps, const std::vector<int>& shown) {
  std::vector<MapSeries> out;
  for (const MapSeries& one : maps) {
    out.push_back({one.name, {}});
    if (one.frames.size() == 1) out.back().frames = one.frames;
    if (one.frames.size() == 1) continue;
    for (const int moment : shown) out.back().frames.push_back(one.frames[static_cast<std::size_t>(moment)]);
  }
  return out;
}

std::vector<int> every(int stride, int last) {
  std::vector<int> out;
  for (int moment = last; moment >= 0; moment -= stride) out.insert(out.begin(), moment);
  return out;
}

}  // namespace

std::string run_page(const Recording& recording, const History& history, const OnProgress& progress) {
  const fs::path& directory = recording.directory;
  const Tree manifest = is_there(directory / "manifest.json") ? read_json(directory / "manifest.json") : Tree::map();
  std::vector<std::pair<std::string, std::string>> data{
      {"version", json_quoted(kVersion)},
      {"run", json_of_run(recording)},
      {"summary", recording.summary ? to_json_line(*recording.summary) : "null"},
      {"taps", json_list_of(recording.rows, to_json_line)},
      {"moments", json_list_of(history.moments, json_of_moment)},
      {"errors", json_list_of(error_fields(), json_of_error)},
      {"curves", json_list_of(curves_of(recording, history), json_of_panel)},
      {"x", json_numbers(history.x)},
      {"y", json_numbers(history.y)},
      {"config", json_of_config(recording, manifest)},
      {"build", json_of_build(manifest)},
      {"warnings", json_texts(warnings_of(recording, history))}};
  const int last = history.moments.back().taps;
  // Maps never pack to a tenth of their bytes: with more than these the page would surely be too large.
  constexpr double kMostRaw = 8e6;
  double raw = 0.0;
  for (const MapSeries& one : history.maps)
    raw += 2.0 * static_cast<double>(one.frames.size()) * static_cast<double>(one.frames.front().size());
  for (int stride = std::max(1, static_cast<int>(raw / kMostRaw));; stride += 1 + stride / 4) {
    progress(last, last);
    const std::vector<int> shown = every(stride, last);
    const PackedMaps maps = pack_maps(thinned(history.maps, shown));
    std::vector<std::pair<std::string, std::string>> all = data;
    all.emplace_back("maps", maps.json);
    all.emplace_back("shown", json_list_of(shown, [](int moment) { return std::to_string(moment); }));
    std::string page = make_page(run_script(), json_object(all), maps.bytes);
    if (page.size() <= kMostPageBytes || shown.size() == 1) return page;
  }
}

}  // namespace palpate
