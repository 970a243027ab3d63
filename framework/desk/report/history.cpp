// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Whether the scores are a map of their own, beside those that are shown anyhow.
bool own_scores(const Snapshot& now) {
  if (now.scores == now.uncertainty) return false;
  return now.has_weight() ? now.scores != now.exploration() : now.scores != now.probability;
}

}  // namespace

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
