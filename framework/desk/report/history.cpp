// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include "record/fields.hpp"
#include "record/summary.hpp"
#include "report/beliefs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// Returns whether the scores differ from all other maps that are shown.
bool own_scores(const MapsAtTap& now) {
  if (!now.has_scores || now.scores == now.uncertainty) return false;
  return now.has_weight() ? now.scores != now.exploration() : now.scores != now.probability;
}

/// Returns the maps after the taps that `playback` has replayed, the first ones of `recording`.
MapsAtTap maps_of(RunReplay& playback, const RecordedRun& recording) {
  Experiment& experiment = playback.experiment();
  HeightMap& belief = height_map_of(experiment);
  MapsAtTap out;
  out.taps = playback.taps();
  for (int i = 0; i < out.taps; ++i)
    out.marks.push_back(
        mark_of(recording, static_cast<std::size_t>(i), experiment.scene().desk(), experiment.counts()));
  out.next = playback.next();
  out.has_scores = !recording.scored_by_program();
  out.is_next_known = out.next || out.has_scores;
  out.scores = out.has_scores ? experiment.scores() : Eigen::VectorXd::Zero(belief.candidates().size());
  experiment.look();
  out.surface = belief.surface().heights;
  out.deviation = belief.values(quantity::kHeightStd);
  out.uncertainty = belief.values(quantity::kUncertainty);
  if (is_footprint_weight(belief)) {
    out.weight = belief.values(quantity::kLabelMean);
    out.least_weight = belief.models().label_map().mean().minCoeff();
    out.most_weight = belief.models().label_map().mean().maxCoeff();
  } else {
    out.probability = belief.values(quantity::kObjectProbability);
  }
  out.largest_deviation = belief.values(quantity::kMeasurementStd).maxCoeff();
  out.result = playback.result();
  if (!belief_option(recording.config.options, "height.outlier_probability").empty())
    out.suspected_outliers = belief.models().suspected_outliers();
  return out;
}

}  // namespace

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

HistoryBuilder::HistoryBuilder(const Workshop& workshop, const RecordedRun& recording)
    : recording_(recording),
      playback_(workshop, recording, page_readers(recording)),
      any_side_(is_any_side(recording)) {
  history_.truth_lost = playback_.truth_lost();
  if (any_side_) {
    add_surface();
    return;
  }
  const CandidateGrid& all = height_map_of(playback_.experiment()).grid();
  stride_ = (std::max(all.columns, all.rows) + kMostCellsAcross - 1) / kMostCellsAcross;
  history_.x = all.xs(Eigen::seq(0, Eigen::last, stride_));
  history_.y = all.ys(Eigen::seq(0, Eigen::last, stride_));
  const bool weight = is_footprint_weight(height_map_of(playback_.experiment()));
  for (const char* name : {"height", "deviation", "u", weight ? "w" : "p", "score"})
    history_.maps.push_back({name, {}});
  add();
}

void HistoryBuilder::advance() {
  playback_.advance_to(playback_.taps() + 1);
  any_side_ ? add_surface() : add();
}

void HistoryBuilder::add_surface() {
  Experiment& experiment = playback_.experiment();
  const SolidsBelief& belief = solids_of(experiment);
  constexpr double kSide = 0.0025;  // cell width, metres; walls of 3 mm are complete at this width
  RunAtTap now;
  now.taps = playback_.taps();
  now.next = playback_.next();
  now.is_next_known = now.next || !recording_.scored_by_program();
  if (now.next) now.next_along = belief.distance(now.next->request.line, belief.solids().best());
  now.result = playback_.result();
  history_.surfaces.push_back(belief.crossings(kSide));
  for (const Crossings::Vertex& one : history_.surfaces.back().vertices)
    now.largest_deviation = std::max(now.largest_deviation, one.deviation);
  if (history_.true_contours.empty() || experiment.scene().effects().push)
    history_.true_contours = true_contours(experiment);
  history_.shown.push_back(now.taps);
  history_.moments.push_back(now);
  // Largest number of values: more than a page can carry, and for a thousand taps gigabytes.
  constexpr std::size_t kMost = 10'000'000;
  thin(kMost);
}

void HistoryBuilder::add() {
  const MapsAtTap now = maps_of(playback_, recording_);
  const Eigen::VectorXd* const maps[]{&now.surface, &now.deviation, &now.uncertainty,
                                      now.has_weight() ? &now.weight : &now.probability, &now.scores};
  for (std::size_t i = 0; i < std::size(maps); ++i) history_.maps[i].frames.push_back(shown(*maps[i]));
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
  constexpr std::size_t kOfAVertex = 7;
  for (const Crossings& one : history_.surfaces) numbers += kOfAVertex * one.vertices.size() + one.inside.size() / 8;
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
  return finished(std::move(out));
}

History HistoryBuilder::take() { return finished(std::move(history_)); }

History HistoryBuilder::finished(History history) const {
  if (history.maps.empty()) return history;
  for (Eigen::VectorXf& frame : history.maps[1].frames) frame = frame.cwiseMin(static_cast<float>(largest_));
  if (!own_scores_) history.maps.pop_back();
  if (truth_) history.maps.push_back({"truth", {*truth_}});
  return history;
}

History make_history(const Workshop& workshop, const RecordedRun& recording, const OnProgress& progress) {
  const auto last = static_cast<int>(recording.taps.size());
  HistoryBuilder builder(workshop, recording);
  progress(0, last);
  while (builder.taps() < last) {
    builder.advance();
    progress(builder.taps(), last);
  }
  return builder.take();
}

}  // namespace palpate
