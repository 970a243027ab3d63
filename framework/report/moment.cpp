// SPDX-License-Identifier: MIT
#include "report/moment.hpp"

#include "experiment/metrics.hpp"

#include <fmt/format.h>

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

std::vector<Moment> moments_at(Playback& playback, const Recording& recording, const std::vector<int>& taps) {
  std::vector<Moment> moments;
  Experiment& experiment = playback.experiment();
  for (const int count : taps) {
    playback.advance_to(count);
    Moment moment;
    moment.taps = count;
    for (int i = 0; i < count; ++i) {
      moment.marks.push_back(mark_of(recording.taps[static_cast<std::size_t>(i)], i + 1, experiment.scene()));
      const TapMark::Kind kind = moment.marks.back().kind;
      ++(kind == TapMark::Kind::on ? moment.on : kind == TapMark::Kind::off ? moment.off : moment.failed);
    }
    // Chosen first, as the run did: what is read for the picture comes after.
    if (const std::optional<TapRecord> next = experiment.choose_next()) moment.next = next->target;
    moment.scores = experiment.scores();
    const TapBelief& belief = experiment.belief();
    moment.surface = reconstruction(belief);
    moment.deviation = belief.height_variance().cwiseMax(0.0).cwiseSqrt();
    moment.uncertainty = belief.uncertainty();
    moment.weight = belief.weight();
    const Eigen::VectorXd all = belief.all_taps_variance().cwiseMax(0.0).cwiseSqrt();
    moment.largest_deviation = all.maxCoeff();
    moment.mean_deviation = all.mean();
    moments.push_back(std::move(moment));
  }
  return moments;
}

std::string count_words(const Moment& moment) {
  std::string out = fmt::format("{} on the object, {} on the desk", moment.on, moment.off);
  if (moment.failed > 0) out += fmt::format(", {} failed", moment.failed);
  return out;
}

}  // namespace palpate
