// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include "experiment/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

TapMark mark_of(const Recording& recording, std::size_t index, double desk) {
  const PastTap& tap = recording.taps[index];
  TapMark mark{static_cast<int>(index) + 1, TapMark::Kind::failed, tap.target.x, tap.target.y, desk};
  if (tap.contact.outcome != Outcome::contact) return mark;
  const Row& row = recording.rows[index];
  mark.kind = row.flag("on_surface").value_or(false) ? TapMark::Kind::on : TapMark::Kind::off;
  mark.height = row.number("corrected_height").value_or(tap.contact.height);
  return mark;
}

/// Whether the scores are a map of their own, beside those that are shown anyhow.
bool own_scores(const Snapshot& now) {
  if (now.scores == now.uncertainty) return false;
  return now.has_weight() ? now.scores != now.exploration() : now.scores != now.probability;
}

/// The run as `playback` has it now, after as many of the taps of `recording`.
Snapshot snapshot_of(Playback& playback, const Recording& recording) {
  Experiment& experiment = playback.experiment();
  const TapBelief& belief = experiment.belief();
  Snapshot out;
  out.taps = playback.taps();
  for (int i = 0; i < out.taps; ++i)
    out.marks.push_back(mark_of(recording, static_cast<std::size_t>(i), experiment.scene().desk()));
  out.next = experiment.choose_next();
  out.scores = experiment.scores();
  experiment.ask(Quantity::uncertainty | Quantity::height | Quantity::probability);
  out.surface = reconstruction(belief);
  out.deviation = belief.height_variance().cwiseSqrt();
  out.uncertainty = belief.uncertainty();
  if (belief.footprint_is_weight()) {
    out.weight = belief.weight();
    out.least_weight = belief.weight_mean().minCoeff();
    out.most_weight = belief.weight_mean().maxCoeff();
  } else {
    out.probability = belief.probability();
  }
  out.largest_deviation = std::sqrt(belief.all_taps_variance().maxCoeff());
  out.result = experiment.result();
  return out;
}

}  // namespace

std::vector<Snapshot> snapshots_at(Playback& playback, const Recording& recording, const std::vector<int>& taps) {
  std::vector<Snapshot> out;
  for (const int count : taps) {
    playback.advance_to(count);
    out.push_back(snapshot_of(playback, recording));
  }
  return out;
}

std::string count_words(const RunResult& result) {
  std::string out = fmt::format("{} on the object, {} on the desk", result.on_surface_taps, result.off_surface_taps);
  if (result.failed_taps > 0) out += fmt::format(", {} failed", result.failed_taps);
  return out;
}

History make_history(const Workshop& workshop, const Recording& recording, const OnProgress& progress) {
  Playback playback(workshop, recording);
  Experiment& experiment = playback.experiment();
  const Candidates& all = experiment.candidates();
  const auto some =
      Eigen::seq(0, Eigen::last, (std::max(all.columns, all.rows) + kMostCellsAcross - 1) / kMostCellsAcross);
  const auto shown = [&](const Eigen::VectorXd& map) -> Eigen::VectorXf {
    const Eigen::MatrixXd cells = map.reshaped<Eigen::RowMajor>(all.rows, all.columns)(some, some);
    return cells.reshaped<Eigen::RowMajor>().cast<float>();
  };
  const bool weight = experiment.belief().footprint_is_weight();
  const std::vector<std::pair<const char*, Eigen::VectorXd Snapshot::*>> maps{
      {"height", &Snapshot::surface},
      {"deviation", &Snapshot::deviation},
      {"u", &Snapshot::uncertainty},
      {weight ? "w" : "p", weight ? &Snapshot::weight : &Snapshot::probability},
      {"score", &Snapshot::scores}};
  History out;
  out.x = all.xs(some);
  out.y = all.ys(some);
  for (const auto& [name, map] : maps) out.maps.push_back({name, {}});
  bool scores = false;
  double largest = 0.0;
  const auto last = static_cast<int>(recording.taps.size());
  for (int taps = 0; taps <= last; ++taps) {
    playback.advance_to(taps);
    const Snapshot now = snapshot_of(playback, recording);
    for (std::size_t i = 0; i < maps.size(); ++i) out.maps[i].frames.push_back(shown(now.*maps[i].second));
    scores = scores || own_scores(now);
    largest = std::max(largest, now.largest_deviation);
    out.moments.push_back(now);
    progress(taps, last);
  }
  for (Eigen::VectorXf& frame : out.maps[1].frames) frame = frame.cwiseMin(static_cast<float>(largest));
  if (!scores) out.maps.pop_back();
  if (const Truth* truth = experiment.truth()) out.maps.push_back({"truth", {shown(truth->height)}});
  return out;
}

}  // namespace palpate
