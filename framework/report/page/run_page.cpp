// SPDX-License-Identifier: MIT
#include "report/page/run_page.hpp"

#include "config/yaml.hpp"
#include "record/build_info.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/run.hpp"
#include "record/run_directory.hpp"
#include "report/colours.hpp"
#include "report/curves.hpp"
#include "report/page/page.hpp"
#include "report/page/warnings.hpp"
#include "report/words/titles.hpp"
#include "report/words/words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>

namespace palpate {
namespace {

Json json_of_run(const RecordedRun& recording, const History& history) {
  const ExperimentOptions& options = recording.config.options;
  return {{"name", options.name},
          {"id", recording.config.id},
          {"seed", options.seed},
          {"budget", options.taps},
          {"acquisition", options.acquisition.type},
          {"footprint", belief_option(options, "footprint.type")},
          {"width", options.scene.area.width},
          {"depth", options.scene.area.depth},
          {"desk", options.scene.desk},
          {"truth", recording.truth_known() && !history.truth_lost},
          {"any_side", recording.is_any_side()}};
}

/// Returns the config as a table of paths, values and origins. An origin is a file from which config.yaml was composed.
Table config_table(const RecordedRun& recording) {
  const std::map<std::string, std::string> known = recorded_origins(recording.directory);
  Table table;
  for (const ResolveNotes::Origin& one : recording.config.notes.origins) {
    const std::string text = to_yaml(*recording.config.tree.find_path(one.path));
    const auto place = known.find(one.path);
    table.add_row();
    table.show("key", one.path, Table::Kind::text);
    table.show("value", text.substr(0, text.find_last_not_of('\n') + 1), Table::Kind::text);
    table.show("source", place != known.end() ? place->second : one.place, Table::Kind::text);
  }
  return table;
}

Table build_table(const Tree& manifest) {
  Table table;
  const auto add = [&](const char* key, const std::string& value) {
    if (value.empty()) return;
    table.add_row();
    for (const std::string& cell : {std::string(key), value}) table.show("", cell, Table::Kind::text);
  };
  for (const char* key : {"version", "commit", "dirty", "compiler", "instruction_path", "host"}) {
    if (const Tree* value = manifest.find(key)) add(key, value->text);
  }
  if (const Tree* line = manifest.find("command_line")) {
    std::vector<std::string> words;
    for (const Tree& word : line->items) words.push_back(word.text);
    add("command line", fmt::format("{}", fmt::join(words, " ")));
  }
  return table;
}

}  // namespace

static void to_json(Json& out, const RelabelledContact& one) { out = one.tap; }
static void to_json(Json& out, const TapReading& one) { out = {{"tap", one.tap}, {"words", doubt_words(one)}}; }

static void to_json(Json& out, const RunAtTap& moment) {
  const RunResult& result = moment.result;
  const Row state{result.state.fields};
  Row errors;
  add_errors(errors, result.errors);
  out = errors;
  out.update({{"taps", moment.taps},
              {"object_taps", result.object_taps},
              {"desk_taps", result.desk_taps},
              {"no_contact_taps", result.no_contact_taps},
              {"failed_taps", result.failed_taps},
              {"relabelled", result.relabelled},
              {"surface_drawn", moment.largest_deviation > 0.0},
              {"robot_seconds", result.robot_seconds},
              {kExpectedError, state.number(kExpectedError)},
              {"least_weight", moment.least_weight},
              {"most_weight", moment.most_weight},
              {"remark", state.text("footprint.remark")},
              {"is_next_known", moment.is_next_known},
              {"suspected_outliers", moment.suspected_outliers}});
  if (moment.next) {
    out["next"] = {{"x", moment.next->target().x},
                   {"y", moment.next->target().y},
                   {"source", source_name(moment.next->request.source)},
                   {"score", moment.next->score},
                   {"ties", moment.next->ties}};
    if (const TapLine& line = moment.next->request.line; !line.from_above)
      out["next"].update({{"z", line.start.z()},
                          {"direction.x", line.direction.x()},
                          {"direction.y", line.direction.y()},
                          {"direction.z", line.direction.z()},
                          {"along", moment.next_along},
                          {"length", line.length}});
  }
}

static void to_json(Json& out, const Curve& curve) { out = {{"name", curve.name}, {"values", curve.values}}; }

static void to_json(Json& out, const CurvePanel& panel) {
  constexpr const char* kAxes[] = {"free", "from_zero", "share",
                                   "logarithmic"};  // names in the order of ValueAxisScale
  out = {{"title", panel.title},
         {"unit", panel.unit},
         {"axis", kAxes[static_cast<std::size_t>(panel.axis)]},
         {"curves", panel.curves}};
}

static void to_json(Json& out, const RecordField& error) { out = {error.name, error_title(error)}; }

std::vector<RecordField> page_errors() {
  std::vector<RecordField> out = error_fields();
  out.insert(out.begin() + 1, *find_summary_field(kExpectedError));
  return out;
}

/// Returns the units in which the page shows errors and robot time.
static Json units_of_page() {
  std::vector<std::string> names{"robot_seconds"};
  for (const RecordField& error : page_errors()) names.push_back(error.name);
  return display_units(names);
}

PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames) {
  constexpr double kMost = 65535.0;
  float least = frames.front().minCoeff();
  float most = least;
  for (const Eigen::VectorXf& frame : frames) {
    least = std::min(least, frame.minCoeff());
    most = std::max(most, frame.maxCoeff());
  }
  PackedMaps out{least, most, {}};
  const double scale = out.most > out.least ? kMost / (out.most - out.least) : 0.0;
  for (const Eigen::VectorXf& frame : frames) {
    std::string high;
    std::uint16_t before = 0;
    for (const float cell : frame) {
      const double value = scale * (static_cast<double>(cell) - out.least);
      const auto level = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, kMost)));
      const auto step = static_cast<std::uint16_t>(level - before);
      out.bytes += static_cast<char>(step & 0xFFU);
      high += static_cast<char>(step >> 8U);
      before = level;
    }
    out.bytes += high;
  }
  return out;
}

/// Returns the rounded values of `get` for all elements in a form that compresses well: the first value, followed by
/// the differences between neighbours.
template <class List, class Get>
static std::vector<long> steps_of(const List& list, const Get& get) {
  std::vector<long> out;
  for (const auto& one : list) out.push_back(std::lround(get(one)));
  std::adjacent_difference(out.begin(), out.end(), out.begin());
  return out;
}

/// Returns the contours of the true surface, in tenths of a millimetre.
static Json true_contours_of(const History& history) {
  Json out = Json::array();
  for (const Ring& ring : history.true_contours) {
    const auto along = [&](Eigen::Index axis) {
      return steps_of(ring, [axis](const Eigen::Vector3d& point) { return 1e4 * point(axis); });
    };
    out.push_back({{"x", along(0)}, {"y", along(1)}, {"z", along(2)}});
  }
  return out;
}

/// Returns a mesh: vertices in tenths of a millimetre, their standard deviations in hundredths of a millimetre, and the
/// vertex indices of the triangles.
static Json json_of_surface(const Surface& mesh) {
  const auto along = [&](Eigen::Index axis) {
    return steps_of(mesh.vertices, [axis](const Surface::Vertex& one) { return 1e4 * one.position(axis); });
  };
  const auto corners = [&](std::size_t corner) {
    return steps_of(mesh.triangles, [corner](const std::array<int, 3>& one) { return one[corner]; });
  };
  const auto deviations =
      steps_of(mesh.vertices, [](const Surface::Vertex& one) { return 1e5 * one.standard_deviation; });
  return {{"x", along(0)},   {"y", along(1)},   {"z", along(2)},          {"i", corners(0)},
          {"j", corners(1)}, {"k", corners(2)}, {"deviation", deviations}};
}

/// Returns the status that the run had when `recording` was read, so that it matches all other data of the page.
static RunStatus status_of(const RecordedRun& recording) {
  if (recording.summary) {
    const auto state = recording.failed() ? RunStatus::State::failed : RunStatus::State::done;
    return {state, 0, recording.summary->text("stop_reason")};
  }
  const RunStatus now = read_standing(recording.directory);
  return {now.end ? RunStatus::State::running : now.state, 0, ""};
}

/// Returns the data that may change with every tap. `history` has at least one moment.
static Json json_of_standing(const RecordedRun& recording, const History& history) {
  const RunStatus status = status_of(recording);
  const Curves curves = curves_of(recording, history);
  return {{"state", state_name(status.state)}, {"stop_reason", status.stop_reason},
          {"summary", recording.summary},      {"curves", curves.panels},
          {"constants", curves.constants},     {"warnings", warnings_of(recording, history)}};
}

static void to_json(Json& out, const ColourScale& one) {
  out = {{"low", one.low}, {"high", one.high}, {"logarithmic", one.logarithmic}, {"label", one.label}};
}

Json run_data(const RecordedRun& recording, const History& history) {
  const Tree manifest = recording.manifest.value_or(Tree::map());
  Json data = json_of_run(recording, history);
  data.update(json_of_standing(recording, history));
  data.update({{"version", kVersion},
               {"taps", recording.rows},
               {"moments", history.moments},
               {"errors", page_errors()},
               {"units", units_of_page()},
               {"titles", map_titles(recording.config.options)},
               {"x", std::vector<double>(history.x.begin(), history.x.end())},
               {"y", std::vector<double>(history.y.begin(), history.y.end())},
               {"true_contours", true_contours_of(history)},
               {"config", config_table(recording)},
               {"build", build_table(manifest)}});
  return data;
}

std::string add_maps(Json& data, const History& history, std::size_t stride, std::string_view only) {
  std::vector<int> shown;
  std::string bytes;
  Json surfaces = Json::array();
  Json described = Json::array();
  const std::size_t last = history.shown.size() - 1;
  for (std::size_t i = last % stride; i <= last; i += stride) {
    shown.push_back(history.shown[i]);
    if (!history.surfaces.empty()) surfaces.push_back(json_of_surface(history.surfaces[i]));
  }
  for (const MapSeries& one : history.maps) {
    if (!only.empty() && one.name != only) continue;
    std::vector<Eigen::VectorXf> frames;
    if (one.name == "truth") frames = one.frames;  // The truth has one frame for all moments.
    for (std::size_t i = last % stride; i <= last && one.name != "truth"; i += stride) frames.push_back(one.frames[i]);
    const PackedMaps packed = pack_maps(frames);
    described.push_back(
        {{"name", one.name}, {"least", packed.least}, {"most", packed.most}, {"frames", frames.size()}});
    for (const Eigen::VectorXf& frame : frames) {
      if (one.name == "deviation")
        described.back()["colours"].push_back(deviation_colours(frame.minCoeff(), frame.maxCoeff()));
    }
    bytes += packed.bytes;
  }
  data["surfaces"] = std::move(surfaces);
  data["maps"] = described;
  data["shown"] = shown;
  return bytes;
}

std::string run_page(const RecordedRun& recording, const History& history, const OnProgress& progress) {
  Json data = run_data(recording, history);
  const int last = history.moments.back().taps;
  // Compression reduces maps to a tenth of their size at best. With more than kMostRaw bytes of uncompressed maps, the
  // page would be too large.
  constexpr double kMostRaw = 19e6;
  double raw = 0.0;
  for (const MapSeries& one : history.maps)
    raw += 2.0 * static_cast<double>(one.frames.size()) * static_cast<double>(one.frames.front().size());
  for (std::size_t stride = std::max<std::size_t>(1, static_cast<std::size_t>(raw / kMostRaw));;
       stride += 1 + stride / 4) {
    progress(last, last);
    const std::string bytes = add_maps(data, history, stride);
    std::string page = make_page(palpate_asset_run, data, bytes);
    if (page.size() <= kMostPageBytes || data["shown"].size() == 1) return page;
  }
}

std::string live_run_page(const RecordedRun& recording, const History& history, const std::string& at) {
  Json data = run_data(recording, history);
  const std::string bytes = add_maps(data, history, 1);
  data["live"] = at;
  return make_page(palpate_asset_run, data, bytes, PageOrigin::server);
}

std::string waiting_page(const std::string& name, const std::string& id, const std::string& why,
                         const std::string& at) {
  return make_page(palpate_asset_run, {{"name", name}, {"id", id}, {"waiting", why}, {"live", at}}, "",
                   PageOrigin::server);
}

std::string run_news(const RecordedRun& recording, const History& history, int moments, const std::string& at) {
  Json news = json_of_standing(recording, history);
  const auto made = history.moments.size();
  const auto known = static_cast<std::size_t>(moments);
  const auto row = [&](std::size_t moment) { return recording.rows.begin() + static_cast<std::ptrdiff_t>(moment) - 1; };
  news["at"] = at;
  news["moments"] = std::vector<RunAtTap>(history.moments.begin() + moments, history.moments.end());
  news["taps"] = known < made ? std::vector<Row>(row(known), row(made)) : std::vector<Row>{};
  if (recording.config.options.scene.effects.values.push) news["true_contours"] = true_contours_of(history);
  if (!history.shown.empty()) news["bytes"] = base64(deflated(add_maps(news, history, 1)));
  return line_of(news);
}

}  // namespace palpate
