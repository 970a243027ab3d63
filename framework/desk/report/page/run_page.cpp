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
#include "report/page/json.hpp"
#include "report/page/packed_maps.hpp"
#include "report/page/page.hpp"
#include "report/page/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <unordered_map>

namespace palpate {
namespace {

namespace fs = std::filesystem;

Json json_of_run(const Recording& recording) {
  const ExperimentOptions& options = recording.config.options;
  const RunStatus status = read_status(recording.directory);
  return {{"name", options.name},
          {"id", recording.config.id},
          {"seed", options.seed},
          {"state", state_name(status.state)},
          {"stop_reason", status.stop_reason},
          {"budget", options.taps},
          {"acquisition", options.acquisition.type},
          {"footprint", options.footprint.type},
          {"width", options.scene.area.width},
          {"depth", options.scene.area.depth},
          {"desk", options.scene.desk},
          {"truth", recording.truth_known()}};
}

Json json_of_moment(const Moment& moment) {
  const RunResult& result = moment.result;
  Row errors;
  add_errors(errors, result.errors);
  Json out = errors;
  out.update({{"taps", moment.taps},
              {"on_surface_taps", result.on_surface_taps},
              {"off_surface_taps", result.off_surface_taps},
              {"failed_taps", result.failed_taps},
              {"robot_seconds", result.robot_seconds},
              {"least_weight", moment.least_weight},
              {"most_weight", moment.most_weight},
              {"remark", result.footprint ? result.footprint->remark : ""}});
  if (moment.next) {
    out["next"] = {{"x", moment.next->target.x},
                   {"y", moment.next->target.y},
                   {"source", source_name(moment.next->source)},
                   {"score", moment.next->score},
                   {"ties", moment.next->ties}};
  }
  return out;
}

Json json_of_panel(const CurvePanel& panel) {
  constexpr const char* kAxes[] = {"free", "from_zero", "share", "logarithmic"};  // by CurveAxis
  Json curves = Json::array();
  for (const Curve& curve : panel.curves) curves.push_back({{"name", curve.name}, {"values", curve.values}});
  return {{"title", panel.title},
          {"unit", panel.unit},
          {"axis", kAxes[static_cast<std::size_t>(panel.axis)]},
          {"curves", curves}};
}

/// How a page calls the errors, and in what unit it has them.
Json json_of_error(const RecordField& field) { return {field.name, field.label, unit_symbol(field.unit)}; }

/// The config as lines of path, value and origin: that of the manifest, which knows the files behind config.yaml.
Json json_of_config(const Recording& recording, const Tree& manifest) {
  std::unordered_map<std::string, std::string> known;
  if (const Tree* origins = manifest.find("origins")) {
    for (const Tree::Entry& entry : origins->entries) known.emplace(entry.key, entry.value.text);
  }
  Json lines;
  for (const ResolveNotes::Origin& one : recording.config.notes.origins) {
    const std::string text = to_yaml(*recording.config.tree.find_path(one.path));
    const auto place = known.find(one.path);
    lines.push_back(
        {one.path, text.substr(0, text.find_last_not_of('\n') + 1), place != known.end() ? place->second : one.place});
  }
  return lines;
}

Json json_of_build(const Tree& manifest) {
  Json lines = Json::array();
  for (const char* key : {"version", "commit", "dirty", "compiler", "instruction_path", "host"}) {
    if (const Tree* value = manifest.find(key)) lines.push_back({key, value->text});
  }
  if (const Tree* line = manifest.find("command_line")) {
    std::vector<std::string> words;
    for (const Tree& word : line->items) words.push_back(word.text);
    lines.push_back({"command line", fmt::format("{}", fmt::join(words, " "))});
  }
  return lines;
}

/// A list of what `get` makes of each.
template <class Item, class Get>
Json json_of_each(const std::vector<Item>& items, const Get& get) {
  Json out = Json::array();
  for (const Item& one : items) out.push_back(get(one));
  return out;
}

}  // namespace

std::string run_page(const Recording& recording, const History& history, const OnProgress& progress) {
  const fs::path& directory = recording.directory;
  const Tree manifest = is_there(directory / "manifest.json") ? read_json(directory / "manifest.json") : Tree::map();
  Json data = json_of_run(recording);
  data.update({{"version", kVersion},
               {"summary", recording.summary},
               {"taps", recording.rows},
               {"moments", json_of_each(history.moments, json_of_moment)},
               {"errors", json_of_each(error_fields(), json_of_error)},
               {"curves", json_of_each(curves_of(recording, history), json_of_panel)},
               {"x", std::vector<double>(history.x.begin(), history.x.end())},
               {"y", std::vector<double>(history.y.begin(), history.y.end())},
               {"config", json_of_config(recording, manifest)},
               {"build", json_of_build(manifest)},
               {"warnings", warnings_of(recording, history)}});
  const int last = history.moments.back().taps;
  // Maps never pack to a tenth of their bytes: with more than these the page would surely be too large.
  constexpr double kMostRaw = 8e6;
  double raw = 0.0;
  for (const MapSeries& one : history.maps)
    raw += 2.0 * static_cast<double>(one.frames.size()) * static_cast<double>(one.frames.front().size());
  for (int stride = std::max(1, static_cast<int>(raw / kMostRaw));; stride += 1 + stride / 4) {
    progress(last, last);
    std::vector<int> shown;  // every stride-th moment, counted from the last
    for (int moment = last % stride; moment <= last; moment += stride) shown.push_back(moment);
    Json described;
    std::string bytes;
    for (const MapSeries& one : history.maps) {
      std::vector<Eigen::VectorXf> frames;
      for (const int moment : shown) frames.push_back(one.frames[static_cast<std::size_t>(moment)]);
      if (one.frames.size() == 1) frames = one.frames;
      const PackedMaps packed = pack_maps(frames);
      described.push_back(
          {{"name", one.name}, {"least", packed.least}, {"most", packed.most}, {"frames", frames.size()}});
      bytes += packed.bytes;
    }
    data["maps"] = described;
    data["shown"] = shown;
    std::string page = make_page(palpate_asset_run, data, bytes);
    if (page.size() <= kMostPageBytes || shown.size() == 1) return page;
  }
}

}  // namespace palpate
