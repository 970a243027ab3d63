// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include "belief/outlier_model.hpp"
#include "gp/candidate_grid.hpp"
#include "record/fields.hpp"
#include "record/surface_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate {
namespace {

TapMark mark_of(const RecordedRun& recording, std::size_t index, double desk, const RunResult& counts) {
  const TapRecord& tap = recording.taps[index];
  TapMark mark{static_cast<int>(index) + 1, TapMark::Kind::failed, tap.target().x, tap.target().y, desk};
  if (!tap.is_contact()) return mark;
  const Row& row = recording.rows[index];
  mark.kind = label_now(row, counts).value_or(false) ? TapMark::Kind::on : TapMark::Kind::off;
  mark.height = row.number("corrected_height").value_or(tap.result.height());
  return mark;
}

/// Returns whether the scores differ from all other maps on the page.
bool own_scores(const MapsAtTap& now) {
  if (!now.has_scores || now.scores == now.uncertainty) return false;
  return now.has_weight() ? now.scores != now.exploration() : now.scores != now.probability;
}

/// Sets the fields that runs from above and from any side have in common, for the moment after the taps that `playback`
/// has replayed.
void set_common(RunAtTap& out, RunReplay& playback, const RecordedRun& recording) {
  const Belief& belief = playback.experiment().belief();
  out.taps = playback.taps();
  out.next = playback.next();
  out.is_next_known = out.next || !recording.scored_by_program();
  if (out.next) {
    const LineFacts facts = belief.explain(out.next->request.line);
    if (!facts.particles.empty()) out.next_along = facts.particles.front().distance;
  }
  out.result = playback.result();
  for (const TapReading& one : belief.taps().readings) {
    if (one.outlier_probability >= OutlierModel::kRetapThreshold) out.suspected_outliers.push_back(one);
  }
}

/// Returns the maps after the taps that `playback` has replayed, which are the first taps of `recording`.
MapsAtTap maps_of(RunReplay& playback, const RecordedRun& recording) {
  Experiment& experiment = playback.experiment();
  Belief& belief = experiment.belief();
  MapsAtTap out;
  set_common(out, playback, recording);
  for (int i = 0; i < out.taps; ++i)
    out.marks.push_back(
        mark_of(recording, static_cast<std::size_t>(i), experiment.scene().desk(), experiment.counts()));
  out.has_scores = !recording.scored_by_program();
  out.scores = out.has_scores ? experiment.scores() : Eigen::VectorXd::Zero(belief.candidates().size());
  experiment.look();
  out.surface = belief.surface(kFineResolution).heights;
  out.deviation = belief.values(quantity::kHeightStd);
  out.uncertainty = belief.values(quantity::kUncertainty);
  const Row state{belief.state(Eigen::Index{0}).fields};
  const bool has_weight = belief.available().count(quantity::kLabelMean) != 0;
  if (state.number("p") || !has_weight) {  // The footprint is not the label GP.
    out.probability = belief.values(quantity::kObjectProbability);
  } else {
    out.weight = belief.values(quantity::kLabelMean);
    out.least_weight = state.number("min_weight");
    out.most_weight = state.number("max_weight");
  }
  out.largest_deviation = belief.values(quantity::kMeasurementStd).maxCoeff();
  return out;
}

/// Returns contours of the true scene in its current state; empty if the truth is unknown.
std::vector<Ring> true_contours(Experiment& experiment) {
  constexpr double kApart = 0.01;
  constexpr double kOfGrid = 0.002;  // metres; fine enough for complete contours of walls 3 mm thick
  const Scene* const truth = experiment.truth();
  return truth != nullptr ? contours(*truth, kApart, kOfGrid) : std::vector<Ring>{};
}

}  // namespace

ReadPlan page_readers(const RecordedRun& recording) {
  using namespace quantity;
  if (recording.is_any_side()) return readers_from_first_tap("page", {});
  return readers_from_first_tap("page", {kUncertainty, kMeasurementStd, kObjectProbability, kHeightMean, kHeightStd});
}

std::vector<MapsAtTap> maps_at_taps(RunReplay& playback, const RecordedRun& recording, const std::vector<int>& taps) {
  std::vector<MapsAtTap> out;
  for (const int count : taps) {
    playback.advance_to(count);
    out.push_back(maps_of(playback, recording));
  }
  return out;
}

std::string count_words(const RunResult& result) {
  std::string out = fmt::format("{} on the object, {} on the desk", result.object_taps, result.desk_taps);
  if (result.failed_taps > 0) out += fmt::format(", {} failed", result.failed_taps);
  return out;
}

HistoryBuilder::HistoryBuilder(const RunEnvironment& environment, const RecordedRun& recording)
    : recording_(recording),
      playback_(environment, recording, page_readers(recording)),
      any_side_(recording.is_any_side()) {
  history_.truth_lost = playback_.truth_lost();
  if (!any_side_) {
    const CandidateGrid all = grid_of(playback_.experiment().belief().candidates());
    stride_ = (std::max(all.columns, all.rows) + kMostCellsAcross - 1) / kMostCellsAcross;
    history_.x = all.xs(Eigen::seq(0, Eigen::last, stride_));
    history_.y = all.ys(Eigen::seq(0, Eigen::last, stride_));
  }
  add();
}

void HistoryBuilder::advance() {
  playback_.advance_to(playback_.taps() + 1);
  add();
}

void HistoryBuilder::add() { any_side_ ? add_surface() : add_maps(); }

void HistoryBuilder::add_surface() {
  Experiment& experiment = playback_.experiment();
  constexpr double kResolution = 0.0025;  // metres; fine enough for complete surfaces of walls 3 mm thick
  RunAtTap now;
  set_common(now, playback_, recording_);
  history_.surfaces.push_back(experiment.belief().surface(kResolution));
  for (const Surface::Vertex& one : history_.surfaces.back().vertices)
    now.largest_deviation = std::max(now.largest_deviation, one.standard_deviation);
  if (history_.true_contours.empty() || experiment.scene().effects().push)
    history_.true_contours = true_contours(experiment);
  history_.shown.push_back(now.taps);
  history_.moments.push_back(now);
  // Largest number of stored values. A page with more values would be too large, and without a limit a thousand taps
  // would need gigabytes.
  constexpr std::size_t kMost = 10'000'000;
  thin(kMost);
}

void HistoryBuilder::add_maps() {
  const MapsAtTap now = maps_of(playback_, recording_);
  const std::pair<const char*, const Eigen::VectorXd*> maps[]{
      {"height", &now.surface},
      {"deviation", &now.deviation},
      {"u", &now.uncertainty},
      now.has_weight() ? std::pair("w", &now.weight) : std::pair("p", &now.probability),
      {"score", &now.scores}};
  history_.maps.resize(std::size(maps));
  for (std::size_t i = 0; i < std::size(maps); ++i) {
    history_.maps[i].name = maps[i].first;
    history_.maps[i].frames.push_back(shown(*maps[i].second));
  }
  own_scores_ = own_scores_ || own_scores(now);
  largest_ = std::max(largest_, now.largest_deviation);
  if (const Scene* const truth = playback_.experiment().truth())
    truth_ = shown(true_heights(playback_.experiment().belief().candidates(), *truth));
  history_.shown.push_back(now.taps);
  history_.moments.push_back(now);
}

Eigen::VectorXf HistoryBuilder::shown(const Eigen::VectorXd& map) {
  const Candidates& all = playback_.experiment().belief().candidates();
  const auto some = Eigen::seq(0, Eigen::last, stride_);
  const Eigen::MatrixXd cells = map.reshaped<Eigen::RowMajor>(all.rows, all.columns)(some, some);
  return cells.reshaped<Eigen::RowMajor>().cast<float>();
}

void HistoryBuilder::thin(std::size_t most) {
  const auto drop = [last = history_.shown.size() - 1](auto& list) {
    std::size_t kept = 0;
    for (std::size_t i = last % 2; i <= last; i += 2) list[kept++] = std::move(list[i]);
    list.resize(kept);
  };
  std::size_t numbers = 0;
  for (const MapSeries& map : history_.maps)
    numbers += map.frames.size() * static_cast<std::size_t>(map.frames.front().size());
  constexpr std::size_t kOfAVertex = 10;  // numbers per vertex, including its share of the triangles
  for (const Surface& one : history_.surfaces) numbers += kOfAVertex * one.vertices.size();
  if (history_.shown.size() < 2 || numbers <= most) return;
  for (MapSeries& map : history_.maps) drop(map.frames);
  if (!history_.surfaces.empty()) drop(history_.surfaces);
  drop(history_.shown);
}

History HistoryBuilder::since(int moment) const {
  const auto first = std::lower_bound(history_.shown.begin(), history_.shown.end(), moment);
  History out{history_.moments,   {first, history_.shown.end()}, {}, history_.x, history_.y, {}, history_.true_contours,
              history_.truth_lost};
  if (!history_.surfaces.empty())
    out.surfaces = {history_.surfaces.end() - (history_.shown.end() - first), history_.surfaces.end()};
  for (const MapSeries& map : history_.maps)
    out.maps.push_back({map.name, {map.frames.end() - (history_.shown.end() - first), map.frames.end()}});
  if (out.maps.empty()) return out;
  for (Eigen::VectorXf& frame : out.maps[1].frames) frame = frame.cwiseMin(static_cast<float>(largest_));
  if (!own_scores_) out.maps.pop_back();
  if (truth_) out.maps.push_back({"truth", {*truth_}});
  return out;
}

History make_history(const RunEnvironment& environment, const RecordedRun& recording, const OnProgress& progress) {
  const auto last = static_cast<int>(recording.taps.size());
  HistoryBuilder builder(environment, recording);
  progress(0, last);
  while (builder.taps() < last) {
    builder.advance();
    progress(builder.taps(), last);
  }
  return builder.since(0);
}

}  // namespace palpate
