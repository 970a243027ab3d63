// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include "lattice_counts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace palpate::footprints {
namespace {

constexpr double kPushMoves = 0.1;  // share of the moves

}  // namespace

Particles::Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random)
    : prior_(prior),
      settings_(settings),
      random_(random),
      exact_(settings.mistaken, settings.lies, 0.0),
      blurred_(settings.mistaken, settings.lies, settings.blur),
      unseen_(prior_, random_) {
  particles_.resize(static_cast<std::size_t>(settings.count));
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    particles_[i].blurred = settings.blur > 0.0 && i % 2 == 1;
  }
}

double Particles::mean_mistakes() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.mistakes;
  return sum / size();
}

double Particles::mean_pieces() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.outline.size();
  return sum / size();
}

std::vector<const Outline*> Particles::some(int count) const {
  std::vector<const Outline*> out;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
    out.push_back(&particles_[k * particles_.size() / static_cast<std::size_t>(count)].outline);
  return out;
}

double Particles::left(double size) const { return 1.0 - std::exp(-unseen_.apart(size)); }

void Particles::doubt(VectorOut out) const {
  out.setZero();
  for (const Particle& particle : particles_) {
    if (!(particle.labels > 0.0)) continue;  // nothing speaks against it
    const LabelModel& labels = this->labels(particle.blurred);
    for (std::size_t i = 0; i < touches_.size(); ++i)
      out(static_cast<Eigen::Index>(i)) += labels.wrong(particle.depths[i], touches_[i].on);
  }
  out /= size();
}

void Particles::place_now(Points& places) const {
  Points sums = Points::Zero(places.rows(), 2);
  std::vector<int> counts(touches_.size(), 0);
  for (const Particle& particle : particles_) {
    for (int i = 0; i < particle.push.before; ++i) {
      const Target now = particle.push.now(touches_[static_cast<std::size_t>(i)].place);
      sums.row(i) += Eigen::RowVector2d(now.x, now.y);
      ++counts[static_cast<std::size_t>(i)];
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (2 * counts[i] > size()) places.row(row) = sums.row(row) / counts[i];
  }
}

Particles::Pushed Particles::pushed() const {
  Pushed out;
  for (const Particle& particle : particles_) {
    if (!particle.push) continue;
    const Form first = particle.outline.size() > 0 ? particle.outline[0].form : Form{};
    const Target then = particle.push.then({first.x, first.y});
    out.share += 1.0;
    out.before += particle.push.before;
    out.shift += std::hypot(first.x - then.x, first.y - then.y);
  }
  if (!(out.share > 0.0)) return out;
  out.before /= out.share;
  out.shift /= out.share;
  out.share /= size();
  return out;
}

Particles::View Particles::look(const Outline& outline, const Target& place, const LabelModel& labels) const {
  View out{LabelModel::kOutside, 0};
  if (!labels.blurs()) {
    for (int i = 0; i < outline.size(); ++i) {
      if (outline[i].contains(place.x, place.y)) out.holders = static_cast<std::uint16_t>(out.holders | 1U << i);
    }
    if (out.holders != 0) out.depth = LabelModel::kInside;
    return out;
  }
  double deepest = -1.0;
  for (int i = 0; i < outline.size(); ++i) {
    // Most pieces are elsewhere, where how far away they are makes no difference.
    const Form& form = outline[i].form;
    const double dx = place.x - form.x;
    const double dy = place.y - form.y;
    const double reach = labels.reach();
    if (dx * dx + dy * dy > 2.0 * (form.a * form.a + form.b * form.b + reach * reach)) continue;
    const double depth = outline[i].depth(place.x, place.y);
    if (depth >= 0.0) out.holders = static_cast<std::uint16_t>(out.holders | 1U << i);
    deepest = std::max(deepest, depth);
  }
  out.depth = labels.step(deepest);
  return out;
}

Particles::View Particles::look_again(std::uint16_t holders, const Outline& outline, int only, const Target& place) {
  const unsigned bit = 1U << only;
  const unsigned others = holders & ~bit;
  const unsigned now = outline[only].contains(place.x, place.y) ? others | bit : others;
  return {now != 0 ? LabelModel::kInside : LabelModel::kOutside, static_cast<std::uint16_t>(now)};
}

double Particles::add(const Touch& touch) {
  const std::size_t number = touches_.size();
  touches_.push_back(touch);
  xs_.push_back(static_cast<float>(touch.place.x));
  ys_.push_back(static_cast<float>(touch.place.y));
  if (touch.on) heights_.add(touch, number);
  const Unseen::Holding unseen = unseen_.holding(touch.place);
  const double something_new = 1.0 - std::exp(-unseen.rate());
  std::vector<double> weights;
  weights.reserve(particles_.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double of_label = 0.0;
  for (Particle& particle : particles_) {
    const LabelModel& labels = this->labels(particle.blurred);
    const View view = look(particle.outline, touch.place, labels);
    particle.holders.push_back(view.holders);
    particle.depths.push_back(view.depth);
    particle.mistakes += labels.mistake(view.depth, touch.on) ? 1 : 0;
    particle.labels += labels.loss(view.depth, touch.on);
    double weight = (1.0 - something_new) * labels.probability(view.depth, touch.on) +
                    something_new * labels.probability(LabelModel::kInside, touch.on);
    of_label += weight;
    if (touch.on && settings_.heights) {
      const double gain = heights_.evidence(particle.holders, particle.outline.size());
      weight *= std::exp(gain - particle.heights);
      particle.heights = gain;
    }
    weights.push_back(weight);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  resample(weights, sum);
  if (touch.on && something_new > 0.0) find(number, unseen, something_new);
  unseen_.add(touch, labels(settings_.blur > 0.0));
  const double left = sum * sum / (sum_of_squares * size());
  const int moves = std::min(settings_.most_moves,
                             static_cast<int>(std::ceil(settings_.moves * std::max(1.0, 0.5 * mean_pieces()) / left)));
  for (Particle& particle : particles_) {
    for (int i = 0; i < moves; ++i) move(particle);
  }
  constexpr int kAsked = 8;
  unseen_.lie_apart_from(some(kAsked));
  return of_label / size();
}

/// Of what was not seen so far, what holds the touch is seen now: a piece, as often as it was there to be found.
void Particles::find(std::size_t number, const Unseen::Holding& unseen, double something_new) {
  for (Particle& particle : particles_) {
    if (particle.outline.size() >= prior_.settings().most) continue;
    const LabelModel& labels = this->labels(particle.blurred);
    const double found = something_new * labels.probability(LabelModel::kInside, true);
    const double known = (1.0 - something_new) * labels.probability(particle.depths[number], true);
    if (random_.uniform() * (found + known) >= found) continue;
    particle.outline.add(unseen.draw(random_));
    particle.mistakes = 0;
    particle.labels = 0.0;
    for (std::size_t i = 0; i <= number; ++i) {
      const View view = look(particle.outline, seen_from(particle, i), labels);
      particle.holders[i] = view.holders;
      particle.depths[i] = view.depth;
      particle.mistakes += labels.mistake(view.depth, touches_[i].on) ? 1 : 0;
      particle.labels += labels.loss(view.depth, touches_[i].on);
    }
    particle.heights = settings_.heights ? heights_.evidence(particle.holders, particle.outline.size()) : 0.0;
  }
}

/// Systematic resampling: one draw, and each outline comes as often as its weight says but for less than one. Those
/// that come stay where they are, and further copies take the places of those that do not.
void Particles::resample(const std::vector<double>& weights, double sum) {
  const double step = sum / static_cast<double>(weights.size());
  const double first = random_.uniform() * step;
  std::vector<int> times(weights.size(), 0);
  std::size_t from = 0;
  double reached = weights.front();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double wanted = first + static_cast<double>(i) * step;
    while (reached < wanted && from + 1 < weights.size()) reached += weights[++from];
    ++times[from];
  }
  std::size_t free = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (; times[i] > 1; --times[i]) {
      while (times[free] > 0) ++free;
      particles_[free] = particles_[i];
      times[free] = 1;
    }
  }
}

void Particles::move(Particle& particle) {
  ++tried_;
  constexpr double kChangesBlur = 0.02;
  Proposal& proposal = proposal_;
  proposal.outline = particle.outline;
  proposal.push = particle.push;
  proposal.correction = 0.0;
  proposal.changed = 0;
  proposal.everywhere = false;
  proposal.only = -1;
  bool blurred = particle.blurred;
  if (settings_.blur > 0.0 && random_.uniform() < kChangesBlur) {
    blurred = !blurred;
    proposal.everywhere = true;
    proposal.correction = 1.0;
  } else if (settings_.pushes > 0.0 && touches_.size() > 1 && random_.uniform() < kPushMoves) {
    propose_push(proposal, prior_, static_cast<int>(touches_.size()), settings_.pushes, random_);
  } else {
    propose(proposal, prior_, {&touches_, &particle.holders}, random_);
  }
  if (proposal.correction > 0.0 && weigh(particle, proposal, blurred)) ++moved_;
}

/// Metropolis and Hastings, in two steps, of which the first is quick: by the labels, then by the heights (delayed
/// acceptance: Christen and Fox 2005). Takes the proposal, or leaves the particle as it was.
bool Particles::weigh(Particle& particle, const Proposal& proposal, bool blurred) {
  const LabelModel& labels = this->labels(blurred);
  const LabelModel& labels_before = this->labels(particle.blurred);
  // So much more loss is allowed. The latest touches are the nearest to the edge: most outlines are given up at these.
  const double allowed = std::log(proposal.correction / (1.0 - random_.uniform()));
  const double allowed_at_most = allowed + particle.labels;
  if (allowed_at_most < 0.0) return false;
  struct Reach {
    float x, y, square;
  };
  std::array<Reach, Proposal::kMostCircles> circles;
  for (int i = 0; i < proposal.changed; ++i) {
    const Proposal::Circle& circle = proposal.circles[static_cast<std::size_t>(i)];
    const auto reach = static_cast<float>(circle.radius + labels.reach() + 1e-5);  // rounding is far below that
    circles[static_cast<std::size_t>(i)] = {static_cast<float>(circle.x), static_cast<float>(circle.y), reach * reach};
  }
  const auto near = [&](float x, float y) {
    for (int i = 0; i < proposal.changed; ++i) {
      const Reach& circle = circles[static_cast<std::size_t>(i)];
      const float dx = x - circle.x;
      const float dy = y - circle.y;
      if (dx * dx + dy * dy <= circle.square) return true;
    }
    return false;
  };
  changed_.clear();
  views_.clear();
  double before = 0.0;
  double loss = 0.0;
  bool held_otherwise = false;
  for (std::size_t touch = touches_.size(); touch-- > 0;) {
    Target place = touches_[touch].place;
    if (static_cast<int>(touch) < proposal.push.before) {
      place = proposal.push.now(place);
      if (!proposal.everywhere && !near(static_cast<float>(place.x), static_cast<float>(place.y))) continue;
    } else if (!proposal.everywhere && !near(xs_[touch], ys_[touch])) {
      continue;
    }
    const bool on = touches_[touch].on;
    const View view = proposal.only >= 0 && !labels.blurs()
                          ? look_again(particle.holders[touch], proposal.outline, proposal.only, place)
                          : look(proposal.outline, place, labels);
    loss += labels.loss(view.depth, on);
    if (loss > allowed_at_most) return false;
    before += labels_before.loss(particle.depths[touch], on);
    held_otherwise = held_otherwise || (on && view.holders != particle.holders[touch]);
    changed_.push_back(touch);
    views_.push_back(view);
  }
  if (loss - before > allowed) return false;
  double heights = particle.heights;
  if (held_otherwise || proposal.outline.size() != particle.outline.size()) {
    holders_ = particle.holders;
    for (std::size_t i = 0; i < changed_.size(); ++i) holders_[changed_[i]] = views_[i].holders;
    // A piece that holds no touch of an object would be one that was not seen.
    unsigned seen = 0;
    for (const std::size_t touch : heights_.touches()) seen |= holders_[touch];
    if (seen + 1 != 1U << proposal.outline.size()) return false;
    if (settings_.heights) heights = heights_.evidence(holders_, proposal.outline.size());
    if (heights < particle.heights && std::log(1.0 - random_.uniform()) > heights - particle.heights) return false;
  }
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    const std::size_t touch = changed_[i];
    const bool on = touches_[touch].on;
    particle.mistakes +=
        (labels.mistake(views_[i].depth, on) ? 1 : 0) - (labels_before.mistake(particle.depths[touch], on) ? 1 : 0);
    particle.holders[touch] = views_[i].holders;
    particle.depths[touch] = views_[i].depth;
  }
  particle.outline = proposal.outline;
  particle.push = proposal.push;
  particle.blurred = blurred;
  particle.labels = proposal.everywhere ? loss : particle.labels + loss - before;
  particle.heights = heights;
  return true;
}

void Particles::probability(const PointsView& places, VectorOut out) {
  Eigen::VectorXd rates(places.rows());
  unseen_.rates(places, rates);
  if (std::optional<LatticeCounts> counts = LatticeCounts::over(places)) {
    for (const Particle& particle : particles_) counts->add(particle.outline);
    counts->sum(out);
  } else {
    out.setZero();
    for (const Particle& particle : particles_) {
      for (Eigen::Index i = 0; i < out.size(); ++i)
        out(i) += particle.outline.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
    }
  }
  out = (1.0 - (1.0 - out.array() / size()) * (-rates.array()).exp()).cwiseMax(0.0).cwiseMin(1.0);
}

void Particles::sample(const PointsView& places, int count, OutlineSample& out) const {
  out.count = count;
  out.holds.setZero(count / 64, places.rows());
  std::optional<LatticeCounts> lattice = LatticeCounts::over(places);
  Random random(touches_.size(), "sample");
  const std::vector<const Outline*> outlines = some(count);
  const std::vector<Outline> unseen = unseen_.draw(count, random);
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    Outline outline = *outlines[k];
    for (const Piece& piece : unseen[k]) {
      const auto meets = [&](const Piece& known) { return meet(known.form, piece.form); };
      if (outline.size() < Outline::kMost && std::any_of(outlines[k]->begin(), outlines[k]->end(), meets))
        outline.add(piece);
    }
    const auto word = static_cast<Eigen::Index>(k / 64);
    const std::uint64_t bit = std::uint64_t{1} << (k % 64);
    if (lattice) {
      lattice->for_each_run(outline, [&](int row, const Cells& cells) {
        for (int i = cells.begin; i < cells.end; ++i) out.holds(word, row * lattice->columns() + i) |= bit;
      });
      continue;
    }
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      if (outline.contains(places(i, 0), places(i, 1))) out.holds(word, i) |= bit;
    }
  }
  out.to_find.resize(places.rows());
  unseen_.to_find(places, out.to_find);
}

}  // namespace palpate::footprints
