// SPDX-License-Identifier: MIT
#include "sampler.hpp"

#include <palpate/math.hpp>

#include <algorithm>

namespace palpate::footprints {
double Sampler::mean_primitives() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.hypothesis.primitives.size();
  return sum / size();
}

template <class Visit>
void Sampler::for_each_label(const Visit& visit) const {
  const Taps& taps = likelihood_.taps();
  std::vector<LabelModel::Step> steps(static_cast<std::size_t>(taps.length()));
  for (const Particle& particle : particles_) {
    if (particle.loss == 0) continue;
    find_deepest(particle.list_rows(), taps.length(), steps.data());
    const LabelModel& labels = likelihood_.labels(particle.hypothesis.noisy);
    for (int i = 0; i < taps.size(); ++i) visit(i, labels, steps[static_cast<std::size_t>(i)], taps.on(i));
  }
}

double Sampler::mean_label_errors() const {
  double sum = 0.0;
  for_each_label([&](int, const LabelModel& labels, LabelModel::Step step, bool on) {
    sum += labels.contradicts(step, on) ? 1.0 : 0.0;
  });
  return sum / size();
}

void Sampler::label_errors(VectorOut out) const {
  out.setZero();
  for_each_label(
      [&](int tap, const LabelModel& labels, LabelModel::Step step, bool on) { out(tap) += labels.wrong(step, on); });
  out /= size();
}

double Sampler::undiscovered_probability(double length) const {
  return 1.0 - math::exp(-undiscovered_.expected_apart(length));
}

void Sampler::current_positions(Points& positions) const {
  Points sums = Points::Zero(positions.rows(), 2);
  const int taps = likelihood_.taps().size();
  std::vector<int> counts(static_cast<std::size_t>(taps), 0);
  for (const Particle& particle : particles_) {
    const Push& push = particle.hypothesis.push;
    for (int i = 0; i < push.before; ++i) {
      const Target now = push.to_current({positions(i, 0), positions(i, 1)});
      sums.row(i) += Eigen::RowVector2d(now.x, now.y);
      ++counts[static_cast<std::size_t>(i)];
    }
  }
  for (int i = 0; i < taps; ++i) {
    const int count = counts[static_cast<std::size_t>(i)];
    if (2 * count > size()) positions.row(i) = sums.row(i) / count;
  }
}

Sampler::MeanPush Sampler::mean_push() const {
  MeanPush out;
  for (const Particle& particle : particles_) {
    const Push& push = particle.hypothesis.push;
    if (!push) continue;
    double shift = 0.0;
    for (const Primitive& one : particle.hypothesis.primitives) {
      const Target then = push.to_original({one.form.x, one.form.y});
      shift += math::hypot(one.form.x - then.x, one.form.y - then.y);
    }
    out.share += 1.0;
    out.before += push.before;
    out.shift += shift / std::max(1, particle.hypothesis.primitives.size());
  }
  if (!(out.share > 0.0)) return out;
  out.before /= out.share;
  out.shift /= out.share;
  out.share /= size();
  return out;
}

void Sampler::prepare(const PointsView& positions) {
  const bool others = undiscovered_.prepare(positions);
  if (!others && prepared_) return;
  spans_.resize(particles_.size());
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    spans_[i].clear();
    undiscovered_.grid().add_spans(particles_[i].hypothesis.primitives, spans_[i]);
  }
  prepared_ = true;
}

void Sampler::probability(const PointsView& positions, VectorOut out) {
  prepare(positions);
  GridSums counts(undiscovered_.grid().size());
  for (const CoverageGrid::Spans& spans : spans_) counts.add(spans, 1);
  Eigen::VectorXd nothing_new = -undiscovered_.rates();
  math::exp(nothing_new.data(), nothing_new.size(), nothing_new.data());
  out = (1.0 - (1.0 - counts.values(1.0 / size()).array()) * nothing_new.array()).cwiseMax(0.0).cwiseMin(1.0);
}

void Sampler::sample(const PointsView& positions, int count, HypothesisSample& out) {
  prepare(positions);
  Random random(sample_seed_, "sample", static_cast<std::uint64_t>(likelihood_.taps().size()));
  const double first = random.uniform();
  const auto drawn = [&](int k) { return std::min(size() - 1, static_cast<int>((k + first) * size() / count)); };
  out.count = count;
  out.holds.setZero(count / 64, positions.rows());
  for (int k = 0; k < count; ++k) {
    // First, bits mark the ends of spans. A prefix XOR then fills the spans.
    const std::uint64_t bit = std::uint64_t{1} << (k % 64);
    for (const CoverageGrid::Span& span : spans_[static_cast<std::size_t>(drawn(k))]) {
      out.holds(k / 64, span.begin) ^= bit;
      if (span.end < positions.rows()) out.holds(k / 64, span.end) ^= bit;
    }
  }
  for (Eigen::Index i = 1; i < positions.rows(); ++i) {
    for (Eigen::Index word = 0; word < out.holds.rows(); ++word) out.holds(word, i) ^= out.holds(word, i - 1);
  }
  out.expected_discovery_area = undiscovered_.expected_extent();
  // Undiscovered primitives that overlap no known primitive are other objects, which `expected_discovery_area` counts.
  CoverageGrid::Spans spans;
  for (const UndiscoveredPrimitives::Member& one : undiscovered_.draw(count, random)) {
    const ShortList<Primitive>& known = particles_[static_cast<std::size_t>(drawn(one.set))].hypothesis.primitives;
    const auto overlaps = [&](const Primitive& other) { return overlap(other.form, one.primitive->form); };
    if (std::none_of(known.begin(), known.end(), overlaps)) continue;
    spans.clear();
    undiscovered_.grid().add_spans(*one.primitive, spans);
    for (const CoverageGrid::Span& span : spans) {
      for (int i = span.begin; i < span.end; ++i) out.holds(one.set / 64, i) |= std::uint64_t{1} << (one.set % 64);
    }
  }
}

}  // namespace palpate::footprints
