// SPDX-License-Identifier: MIT
#include "sampler.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace palpate::footprints {
namespace {

// Fractions of the moves.
constexpr double kNoiseMoves = 0.02;
constexpr double kPushMoves = 0.10;
// Largest contribution of primitives far from the tap to the number of moves.
constexpr double kMostFar = 3.0;
// Number of taps after a discovery for which the number of particles is doubled.
constexpr int kDoubledTaps = 10;

/// Distance in metres within which primitives are exchanged together.
constexpr double kTogether = 0.01;

bool are_close(const Form& one, const Form& other) {
  Form wide = one;
  wide.a += kTogether;
  wide.b += kTogether;
  return overlap(wide, other);
}

void copy_row(const TapRows& from, int row, TapRows& to, int to_row) {
  std::copy_n(from.row(row), from.length(), to.row(to_row));
}

}  // namespace

bool resample_partially(const Particle& from, const Taps& taps, int most, Particle& to) {
  if (from.hypothesis.push || to.hypothesis.push || from.hypothesis.noisy != to.hypothesis.noisy) return false;
  const std::array<const Particle*, 2> sides{&from, &to};
  struct Member {
    std::size_t side;
    int index;
  };
  std::vector<Member> rest, exchanged;
  const Target latest = taps[taps.size() - 1];
  for (std::size_t side = 0; side < 2; ++side)
    for (int i = 0; i < sides[side]->hypothesis.primitives.size(); ++i)
      (sides[side]->hypothesis.primitives[i].near(latest) ? exchanged : rest).push_back({side, i});
  const auto form = [&](const Member& one) { return sides[one.side]->hypothesis.primitives[one.index].form; };
  const auto row = [&](const Member& one) { return sides[one.side]->rows.row(one.index); };
  for (std::size_t done = 0; done < exchanged.size(); ++done) {
    const Member one = exchanged[done];
    const auto stays = [&](const Member& other) {
      return !are_close(form(one), form(other)) && !share_object(row(one), row(other), taps);
    };
    const auto joining = std::stable_partition(rest.begin(), rest.end(), stays);
    std::copy(joining, rest.end(), std::back_inserter(exchanged));
    rest.erase(joining, rest.end());
  }
  const auto of_side = [](std::size_t side) { return [side](const Member& one) { return one.side == side; }; };
  const auto staying = std::count_if(rest.begin(), rest.end(), of_side(1));
  const auto coming = std::count_if(exchanged.begin(), exchanged.end(), of_side(0));
  if (staying == 0 || staying + coming > most) return false;
  int count = 0;
  for (const Member& one : rest) {
    if (one.side != 1) continue;
    to.hypothesis.primitives[count] = to.hypothesis.primitives[one.index];
    copy_row(to.rows, one.index, to.rows, count++);
  }
  while (to.hypothesis.primitives.size() > count) to.hypothesis.primitives.remove(to.hypothesis.primitives.size() - 1);
  for (const Member& one : exchanged) {
    if (one.side != 0) continue;
    to.hypothesis.primitives.add(from.hypothesis.primitives[one.index]);
    copy_row(from.rows, one.index, to.rows, count++);
  }
  return true;
}

RowList Particle::list_rows() const {
  RowList out;
  for (int i = 0; i < hypothesis.primitives.size(); ++i) out.add(rows.row(i));
  return out;
}

Likelihood::Likelihood(const SamplerSettings& settings)
    : has_heights_(settings.heights),
      labels_{LabelModel(settings.label_error, settings.false_contact, 0.0),
              LabelModel(settings.label_error, settings.false_contact, settings.position_noise)} {}

void Likelihood::add(const Touch& touch) {
  taps_.add(touch);
  if (touch.on) heights_.add(touch);
}

LogUnits Likelihood::loss(const RowList& rows, bool noisy) {
  steps_.resize(static_cast<std::size_t>(taps_.length()));
  find_deepest(rows, taps_.length(), steps_.data());
  return labels(noisy).loss(steps_.data(), taps_.labels(), taps_.length());
}

LogUnits Likelihood::evidence(const RowList& rows) {
  if (!has_heights_) return 0;
  holders_.clear();
  for (int tap = 0; tap < taps_.size(); ++tap) {
    if (!taps_.on(tap)) continue;
    unsigned bits = 0;
    for (int i = 0; i < rows.size(); ++i) bits |= LabelModel::inside(rows[i][tap]) ? 1U << i : 0U;
    holders_.push_back(static_cast<std::uint16_t>(bits));
  }
  return heights_.evidence(holders_, rows.size());
}

void Likelihood::weigh(Particle& particle) {
  const RowList rows = particle.list_rows();
  particle.loss = loss(rows, particle.hypothesis.noisy);
  particle.heights = evidence(rows);
}

LabelModel::Step Likelihood::add_latest(Particle& particle) const {
  const LabelModel& labels = this->labels(particle.hypothesis.noisy);
  const int tap = taps_.size() - 1;
  const Target place = taps_[tap];
  particle.rows.grow(taps_.length());
  LabelModel::Step out = LabelModel::kOutside;
  for (int i = 0; i < particle.hypothesis.primitives.size(); ++i) {
    const Primitive& one = particle.hypothesis.primitives[i];
    LabelModel::Step& step = particle.rows.row(i)[tap];
    step = one.near(place, labels.reach()) ? labels.step(one.depth(place.x, place.y)) : LabelModel::kOutside;
    out = std::max(out, step);
  }
  return out;
}

Sampler::Sampler(const Prior& prior, const SamplerSettings& settings, Random random)
    : prior_(prior),
      settings_(settings),
      random_(random),
      sample_seed_(random_.bits()),
      likelihood_(settings),
      chain_(prior, settings),
      undiscovered_(prior_, random_) {
  particles_.resize(static_cast<std::size_t>(settings.particles));
  for (std::size_t i = 0; i < particles_.size(); ++i)
    particles_[i].hypothesis.noisy = settings.position_noise > 0.0 && i % 2 == 1;
}

// A tap discovers at most one new primitive. The tap is assumed to be so deep inside it that position noise does not
// matter, so primitives whose rim is just beside the tap are not discovered. The weights ignore the heights in a
// discovered primitive. A particle with the maximum number of primitives discovers nothing. Later moves correct these
// approximations. With 4 mm of noise, the error of probabilities was below 0.01. With heights in the weights, the
// accuracy of the default did not change.
double Sampler::add(const Touch& touch) {
  likelihood_.add(touch);
  const Taps& taps = likelihood_.taps();
  prepared_ = false;
  const UndiscoveredPrimitives::CoveringDraws covering = undiscovered_.covering(touch.place);
  const double p_new = 1.0 - math::exp(-covering.rate());
  std::vector<double> weights;
  weights.reserve(particles_.size());
  double sum = 0.0, sum_of_squares = 0.0, p_label = 0.0;
  for (Particle& particle : particles_) {
    const LabelModel& labels = likelihood_.labels(particle.hypothesis.noisy);
    const LabelModel::Step step = likelihood_.add_latest(particle);
    particle.loss += labels.loss(step, touch.on);
    double weight =
        (1.0 - p_new) * labels.probability(step, touch.on) + p_new * labels.probability(LabelModel::kInside, touch.on);
    p_label += weight;
    if (touch.on) {
      const LogUnits heights = likelihood_.evidence(particle.list_rows());
      weight *= math::exp(from_units(heights - particle.heights));
      particle.heights = heights;
    }
    weights.push_back(weight);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  const int before = size();
  const double p_found = before * p_new * likelihood_.labels(false).probability(LabelModel::kInside, true);
  if (touch.on && 2.0 * p_found > p_label) doubled_until_ = taps.size() + kDoubledTaps;
  const bool doubled = taps.size() < doubled_until_;
  resample(weights, sum, static_cast<std::size_t>(doubled ? 2 * settings_.particles : settings_.particles));
  if (touch.on && p_new > 0.0) discover(covering, p_new);
  undiscovered_.add(touch, likelihood_.labels(settings_.position_noise > 0.0));
  const int times = count_moves(sum * sum / (sum_of_squares * before));
  for (Particle& particle : particles_) chain_.move(particle, times, likelihood_, random_);
  constexpr std::size_t kCompared = 8;
  std::vector<const Hypothesis*> known;
  for (std::size_t k = 0; k < kCompared; ++k)
    known.push_back(&particles_[k * particles_.size() / kCompared].hypothesis);
  undiscovered_.compare(known);
  return p_label / before;
}

/// Adds a random undiscovered primitive at the tap to some particles: to each with the probability, given the object
/// label, that the tap discovered one. `p_new` is the probability before the label is known.
void Sampler::discover(const UndiscoveredPrimitives::CoveringDraws& covering, double p_new) {
  const Taps& taps = likelihood_.taps();
  const int tap = taps.size() - 1;
  Taps seen;
  for (Particle& particle : particles_) {
    const int count = particle.hypothesis.primitives.size();
    if (count >= prior_.settings().most) continue;
    const LabelModel& labels = likelihood_.labels(particle.hypothesis.noisy);
    LabelModel::Step step = LabelModel::kOutside;
    for (int i = 0; i < count; ++i) step = std::max(step, particle.rows.row(i)[tap]);
    const double found = p_new * labels.probability(LabelModel::kInside, true);
    const double known = (1.0 - p_new) * labels.probability(step, true);
    if (random_.uniform() * (found + known) >= found) continue;
    const Primitive& primitive = particle.hypothesis.primitives.add(covering.draw(random_));
    seen.set_after_push(taps, particle.hypothesis.push);
    seen.steps(primitive, labels, particle.rows.row(count));
    likelihood_.weigh(particle);
  }
}

/// Systematic resampling with one random number: the number of copies is proportional to the weight, up to rounding.
/// The first copy stays at its index. Every further copy replaces a particle without copies, or only some of its
/// primitives (resample_partially()).
void Sampler::resample(const std::vector<double>& weights, double sum, std::size_t count) {
  const double step = sum / static_cast<double>(count);
  const double first = random_.uniform() * step;
  particles_.resize(std::max(count, weights.size()));
  std::vector<int> copies(particles_.size(), 0);
  std::size_t from = 0;
  double cumulative = weights.front();
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted = first + static_cast<double>(i) * step;
    while (cumulative < wanted && from + 1 < weights.size()) cumulative += weights[++from];
    ++copies[from];
  }
  // Indices of particles without copies, separately for exact and noisy ones, in descending order. There are as many as
  // further copies and particles that must move to the front together.
  std::array<std::vector<std::size_t>, 2> free;
  for (std::size_t i = count; i-- > 0;) {
    if (copies[i] == 0) free[particles_[i].hypothesis.noisy ? 1 : 0].push_back(i);
  }
  const auto next_free = [&](const Particle& copied) -> Particle& {
    const std::size_t noisy = copied.hypothesis.noisy ? 1 : 0;
    std::vector<std::size_t>& chosen = free[free[noisy].empty() ? 1 - noisy : noisy];
    const std::size_t index = chosen.back();
    chosen.pop_back();
    return particles_[index];
  };
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (int more = copies[i]; more > 1; --more) {
      Particle& other = next_free(particles_[i]);
      if (resample_partially(particles_[i], likelihood_.taps(), prior_.settings().most, other)) {
        likelihood_.weigh(other);
      } else {
        other = particles_[i];
      }
    }
  }
  // If the number of particles decreases, the last ones move to the front.
  for (std::size_t i = count; i < particles_.size(); ++i) {
    if (copies[i] > 0) next_free(particles_[i]) = std::move(particles_[i]);
  }
  particles_.resize(count);
}

/// Returns the number of moves per particle after a tap. `effective_share` is the effective sample size after the tap
/// as a fraction of all particles. The number depends on the particles that are then moved, which biases the chain by
/// O(1 / particles).
int Sampler::count_moves(double effective_share) const {
  const Taps& taps = likelihood_.taps();
  const Target latest = taps[taps.size() - 1];
  double sum = 0.0;
  for (const Particle& particle : particles_) {
    double far = 0.0;
    for (const Primitive& one : particle.hypothesis.primitives)
      (one.near(latest) ? sum : far) += one.hollow ? 2.0 : 1.0;
    sum += std::min(far, kMostFar);
  }
  const double each = settings_.moves + settings_.moves_apart * (1.0 / effective_share - 1.0);
  return std::min(settings_.most_moves, static_cast<int>(std::ceil(std::max(1.0, sum / size()) * each)));
}

void MarkovChain::move(Particle& particle, int times, Likelihood& likelihood, Random& random) {
  const Taps& taps = likelihood.taps();
  const double noise = settings_.position_noise > 0.0 ? kNoiseMoves : 0.0;
  const double push = settings_.push_probability > 0.0 && taps.size() > 1 ? kPushMoves : 0.0;
  seen_.set_after_push(taps, particle.hypothesis.push);
  for (int i = 0; i < times; ++i) {
    const double which = random.uniform();
    if (which < noise) {
      propose_noise(proposal_, particle.hypothesis);
    } else if (which < noise + push) {
      propose_push(proposal_, particle.hypothesis, prior_, taps.size(), settings_.push_probability, random);
    } else {
      propose(proposal_, particle.hypothesis, prior_, seen_, (which - noise - push) / (1.0 - noise - push), random);
    }
    ++tried_;
    if (!(proposal_.ratio > 0.0)) continue;
    const bool pushes = proposal_.kind == Proposal::Kind::push;
    if (pushes) pushed_.set_after_push(taps, proposal_.push);
    if (!accept(particle, pushes ? pushed_ : seen_, likelihood, random)) continue;
    ++accepted_;
    if (pushes) std::swap(seen_, pushed_);
  }
}

/// Accepts or rejects the proposal by the Metropolis-Hastings rule in two steps: first with the labels, then with the
/// heights, which take longer (delayed acceptance: Christen and Fox 2005). `taps`: positions after the push of the
/// proposal.
bool MarkovChain::accept(Particle& particle, const Taps& taps, Likelihood& likelihood, Random& random) {
  const Proposal& proposal = proposal_;
  // The density of a long push may underflow, so the ratio is limited.
  const double ratio = std::min(proposal.ratio / (1.0 - random.uniform()), std::numeric_limits<double>::max());
  if (particle.loss == 0 && ratio < 1.0) return false;  // losses are at least 0; most moves need no logarithm
  const auto most = particle.loss + static_cast<LogUnits>(std::floor(math::log(ratio) * 0x1p20));
  if (most < 0) return false;
  const LabelModel& labels = likelihood.labels(proposal.noisy);
  added_.grow(taps.length());
  RowList added_rows;
  for (int i = 0; i < proposal.added.size(); ++i) {
    taps.steps(proposal.added[i], labels, added_.row(i));
    added_rows.add(added_.row(i));
  }
  RowList rows = particle.list_rows();
  proposal.apply(added_rows, rows);
  const LogUnits loss = likelihood.loss(rows, proposal.noisy);
  if (loss > most) return false;
  // Rejects primitives without an object tap, because UndiscoveredPrimitives represents them.
  for (const LabelModel::Step* row : added_rows) {
    if (!holds_object(row, taps)) return false;
  }
  bool same_objects = proposal.added.size() == proposal.removed.size();
  for (int i = 0; i < proposal.added.size() && same_objects; ++i)
    same_objects = !hold_different_objects(added_rows[i], particle.rows.row(proposal.removed[i]), taps);
  LogUnits heights = particle.heights;
  if (!same_objects) {
    heights = likelihood.evidence(rows);
    if (heights < particle.heights && math::log(1.0 - random.uniform()) > from_units(heights - particle.heights))
      return false;
  }
  particle.loss = loss;
  particle.heights = heights;
  particle.rows.set(rows);
  proposal.apply(proposal.added, particle.hypothesis.primitives);
  particle.hypothesis.push = proposal.push;
  particle.hypothesis.noisy = proposal.noisy;
  return true;
}

}  // namespace palpate::footprints
