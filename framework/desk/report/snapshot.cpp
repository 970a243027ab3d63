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
  for (int i = 0; i < out.taps; ++i) {
    out.marks.push_back(mark_of(recording.taps[static_cast<std::size_t>(i)], i + 1, experiment.scene()));
    const TapMark::Kind kind = out.marks.back().kind;
    ++(kind == TapMark::Kind::on ? out.on : kind == TapMark::Kind::off ? out.off : out.failed);
  }
  out.next = experiment.choose_next();
  out.scores = experiment.scores();
  experiment.ask(Quantity::uncertainty | Quantity::height | Quantity::probability);
  out.surface = reconstruction(belief);
  out.deviation = belief.height_variance().cwiseSqrt();
  out.uncertainty = belief.uncertainty();
  if (belief.footprint_is_weight()) {
    out.weight = belief.weight();
  } else {
    out.probability = belief.probability();
  }
  out.largest_deviation = std::sqrt(belief.all_taps_variance().maxCoeff());
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

std::string count_words(const Snapshot& snapshot) {
  std::string out = fmt::format("{} on the object, {} on the desk", snapshot.on, snapshot.off);
  if (snapshot.failed > 0) out += fmt::format(", {} failed", snapshot.failed);
  return out;
}

}  // namespace palpate
