// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include "lattice_counts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace palpate::footprints {
namespace {

/// The loss from which on a label counts as wrong: half of that of one which no blur explains.
constexpr double kMistake = 0.5;

constexpr double kPushMoves = 0.1;  // share of the moves

}  // namespace

LabelModel::LabelModel(const ParticleSettings& settings, double blur)
    : blurs_(blur > 0.0), units_(std::log((1.0 - settings.mistaken) / settings.mistaken)) {
  constexpr double kDeviations = 3.5;  // beyond, the place decides in one of some thousand touches
  // Without a blur a step is so short that no touch is within one of a rim.
  const double reach = kDeviations * std::max(blur, 1e-12);
  steps_per_metre_ = 0.5 * kSteps / reach;
  for (int place = 0; place < kSteps + 2; ++place) {
    const double depth = ((place - 0.5) / (0.5 * kSteps) - 1.0) * kDeviations;
    double inside = 0.5 * std::erfc(-depth / std::sqrt(2.0));
    if (place == 0) inside = 0.0;
    if (place == kSteps + 1) inside = 1.0;
    const double on = inside * (1.0 - settings.mistaken) + (1.0 - inside) * settings.lies;
    const double off = inside * settings.mistaken + (1.0 - inside) * (1.0 - settings.lies);
    table_.push_back({off, std::log((1.0 - settings.lies) / off) / units_, inside * settings.mistaken / off});
    table_.push_back({on, std::log((1.0 - settings.mistaken) / on) / units_, (1.0 - inside) * settings.lies / on});
  }
}

Particles::Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random)
    : prior_(prior), settings_(settings), random_(random), exact_(settings, 0.0), blurred_(settings, settings.blur) {
  particles_.reserve(static_cast<std::size_t>(settings.count));
  for (int i = 0; i < settings.count; ++i) {
    const Outline outline = prior_.draw(random_);
    particles_.push_back({{outline, prior_.density(outline), {}}, 0, 0.0, false});
    particles_.back().blurred = settings.blur > 0.0 && i % 2 == 1;
  }
}

double Particles::mean_mistakes() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.mistakes;
  return sum / static_cast<double>(particles_.size());
}

void Particles::doubt(VectorOut out) const {
  out.setZero();
  // Half of them tell it as well: pairs of neighbours, of which one believed in a blur at first.
  std::size_t asked = 0;
  for (std::size_t one = 0; one < particles_.size(); ++one) {
    if (one % 4 >= 2) continue;
    ++asked;
    const Particle& particle = particles_[one];
    if (!(particle.loss > 0.0)) continue;  // nothing speaks against it
    const LabelModel& labels = this->labels(particle.blurred);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const double depth = labels.depth(particle.outline, seen_from(particle, i));
      out(static_cast<Eigen::Index>(i)) += labels.wrong(depth, touches_[i].on);
    }
  }
  out /= static_cast<double>(asked);
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
    const Target now{particle.outline.first.x, particle.outline.first.y};
    const Target then = particle.push.then(now);
    out.share += 1.0;
    out.before += particle.push.before;
    out.shift += std::hypot(now.x - then.x, now.y - then.y);
  }
  if (!(out.share > 0.0)) return out;
  out.before /= out.share;
  out.shift /= out.share;
  out.share /= size();
  return out;
}

double Particles::share_of_one() const {
  const auto one = [](const Particle& particle) { return particle.outline.kind == Outline::Kind::one; };
  return static_cast<double>(std::count_if(particles_.begin(), particles_.end(), one)) /
         static_cast<double>(particles_.size());
}

double Particles::add(const Touch& touch) {
  touches_.push_back(touch);
  std::vector<double> weights;
  weights.reserve(particles_.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (Particle& particle : particles_) {
    const LabelModel& labels = this->labels(particle.blurred);
    const double depth = labels.depth(particle.outline, touch.place);
    const double loss = labels.loss(depth, touch.on);
    if (loss > kMistake) ++particle.mistakes;
    particle.loss += loss;
    const double weight = labels.probability(depth, touch.on);
    weights.push_back(weight);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  resample(weights, sum);
  const auto count = static_cast<double>(particles_.size());
  const double left = sum * sum / (sum_of_squares * count);
  const int moves = std::min(settings_.most_moves, static_cast<int>(std::ceil(settings_.moves / left)));
  for (Particle& particle : particles_) {
    for (int i = 0; i < moves; ++i) move(particle);
  }
  return sum / count;
}

/// Systematic resampling: one draw, and each outline comes as often as its weight says but for less than one.
void Particles::resample(const std::vector<double>& weights, double sum) {
  const double step = sum / static_cast<double>(weights.size());
  const double first = random_.uniform() * step;
  std::vector<Particle> drawn;
  drawn.reserve(particles_.size());
  std::size_t from = 0;
  double reached = weights.front();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double wanted = first + static_cast<double>(i) * step;
    while (reached < wanted && from + 1 < weights.size()) reached += weights[++from];
    drawn.push_back(particles_[from]);
  }
  particles_.swap(drawn);
}

void Particles::move(Particle& particle) {
  ++tried_;
  constexpr double kChangesBlur = 0.05;
  const bool changes_blur = settings_.blur > 0.0 && random_.uniform() < kChangesBlur;
  const bool blurred = particle.blurred != changes_blur;
  const LabelModel& labels = this->labels(blurred);
  const bool pushes = settings_.pushes > 0.0 && touches_.size() > 1 && random_.uniform() < kPushMoves;
  const Proposal proposal =
      changes_blur ? Proposal{particle, 1.0}
      : pushes     ? propose_push(particle, prior_, static_cast<int>(touches_.size()), settings_.pushes, random_)
                   : propose(particle, prior_, touches_, random_);
  if (!(proposal.correction > 0.0)) return;
  // Metropolis and Hastings: taken if a uniform number is below the ratio of the likelihoods times the correction. So
  // much loss is allowed, and most outlines are given up before all labels are looked at: the latest are the nearest to
  // the edge.
  const double allowed = particle.loss + std::log(proposal.correction / (1.0 - random_.uniform())) / labels.units();
  if (allowed < 0.0) return;
  int mistakes = 0;
  double loss = 0.0;
  for (auto i = static_cast<int>(touches_.size()); i-- > 0;) {
    const Touch& touch = touches_[static_cast<std::size_t>(i)];
    const Target place = i < proposal.push.before ? proposal.push.now(touch.place) : touch.place;
    const double one = labels.loss(proposal.outline, place, touch.on);
    mistakes += one > kMistake ? 1 : 0;
    loss += one;
    if (loss > allowed) return;
  }
  particle = {proposal, mistakes, loss, blurred};
  ++moved_;
}

void Particles::count_inside(const PointsView& places, VectorOut inside) const {
  if (std::optional<LatticeCounts> counts = LatticeCounts::over(places)) {
    for (const Particle& particle : particles_) counts->add(particle.outline);
    return counts->sum(inside);
  }
  inside.setZero();
  for (const Particle& particle : particles_) {
    for (Eigen::Index i = 0; i < inside.size(); ++i) {
      inside(i) += particle.outline.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
    }
  }
}

}  // namespace palpate::footprints
