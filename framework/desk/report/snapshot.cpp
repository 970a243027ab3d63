// SPDX-License-Identifier: MIT
#include "report/snapshot.hpp"

#include "experiment/metrics.hpp"

#include <fmt/format.h>

#include <cmath>

namespace palpate {
namespace {

TapMark mark_of(const PastTap& tap, int number, const Scene& scene) {
  TapMark mark{number, TapMark::Kind::failed, tap.target.x, tap.target.y, scene.desk()};
  if (tap.contact.outcome != Outcome::contact) return mark;
  mark.kind = scene.on_surface(tap.contact.height) ? TapMark::Kind::on : TapMark::Kind::off;
  mark.height = tap.contact.height;
  return mark;
}

}  // namespace

Snapshot snapshot_of(Playback& playback, const Recording& recording) {
  Experiment& experiment = playback.experiment();
  const TapBelief& belief = experiment.belief();
  Snapshot out;
  out.taps = playback.taps();
  for (int i = 0; i < out.taps; ++i)
    out.marks.push_back(mark_of(recording.taps[static_cast<std::size_t>(i)], i + 1, experiment.scene()));
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

}  // namespace palpate
