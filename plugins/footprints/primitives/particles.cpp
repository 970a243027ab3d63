// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include "exchange.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace palpate::footprints {
namespace {

// Shares of the moves.
constexpr double kBlurMoves = 0.02;
constexpr double kPushMoves = 0.10;
// Moves for the sake of forms that the touch tells nothing of are as many as for so many of them at most.
constexpr double kElsewhere = 3.0;
// Touches for which what was found is new.
constexpr std::size_t kNew = 10;
constexpr double kLogOfTwo = 0.69314718055994531;

/// How deep a place lies in a piece. Most pieces are elsewhere, where how far away they are makes no difference.
double depth_of(const Piece& piece, const Target& place, double reach) {
  return piece.near(place, reach) ? std::max(-1.0, piece.depth(place.x, place.y)) : -1.0;
}

/// The logarithm of a number above 0, or up to 0.06 more: between the powers of two that of base two is above a line,
/// and by less than kAboveLine.
double log_above(double x) {
  constexpr double kAboveLine = 0.0861;
  std::int64_t bits;
  std::memcpy(&bits, &x, sizeof(bits));
  return (static_cast<double>(bits) * 0x1p-52 - (1023.0 - kAboveLine)) * kLogOfTwo;
}
/// The same or up to 0.06 less.
double log_below(double x) { return log_above(x) - 0.06; }

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

void Particles::look(Particle& particle) const {
  const LabelModel& labels = this->labels(particle.blurred);
  const std::size_t touch = touches_.size() - 1;
  const Target& place = touches_[touch].place;
  LabelModel::Step deepest = LabelModel::kOutside;
  particle.depths.grow_to(places_.length());
  for (int i = 0; i < particle.outline.size(); ++i) {
    const Piece& piece = particle.outline[i];
    const LabelModel::Step step = labels.blurs() ? labels.step(depth_of(piece, place, labels.reach()))
                                  : piece.contains(place.x, place.y) ? LabelModel::kInside
                                                                     : LabelModel::kOutside;
    particle.depths.row(i)[touch] = step;
    deepest = std::max(deepest, step);
  }
  particle.depths.deepest()[touch] = deepest;
}

double Particles::evidence(const LabelModel::Step* const* rows, int pieces) {
  if (!settings_.heights) return 0.0;
  holders_.resize(objects_.size());
  holders_of(rows, pieces, places_.length(), holders_.data());
  return heights_.evidence(holders_, pieces);
}

bool Particles::all_touched(const LabelModel::Step* const* rows, int pieces) const {
  return std::all_of(rows, rows + pieces,
                     [&](const LabelModel::Step* row) { return holds_any(row, objects_.data(), places_.length()); });
}

const Places& Particles::carried_by(const Push& push) {
  // Most moves of an outline leave its push as it is.
  if (pushed_places_.size() != places_.size() || !(pushed_by_ == push)) {
    places_.seen_after(push, pushed_places_);
    pushed_by_ = push;
  }
  return pushed_places_;
}

double Particles::add(const Touch& touch) {
  const std::size_t number = touches_.size();
  touches_.push_back(touch);
  places_.add(touch.place);
  objects_.resize(static_cast<std::size_t>(places_.length()), 0);
  objects_[number] = touch.on ? 0xFF : 0;
  of_objects_ += touch.on ? 1 : 0;
  depths_.grow_to(places_.length());
  if (touch.on) heights_.add(touch, number);
  const Unseen::Holding unseen = unseen_.holding(touch.place);
  const double something_new = 1.0 - math::exp(-unseen.rate());
  std::vector<double> weights;
  weights.reserve(particles_.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double of_label = 0.0;
  for (Particle& particle : particles_) {
    const LabelModel& labels = this->labels(particle.blurred);
    look(particle);
    const LabelModel::Step depth = particle.depths.deepest()[number];
    particle.mistakes += labels.mistake(depth, touch.on) ? 1 : 0;
    particle.labels += labels.loss(depth, touch.on);
    double weight = (1.0 - something_new) * labels.probability(depth, touch.on) +
                    something_new * labels.probability(LabelModel::kInside, touch.on);
    of_label += weight;
    if (touch.on && settings_.heights) {
      const double gain = evidence(particle.depths.rows().data(), particle.outline.size());
      weight *= math::exp(gain - particle.heights);
      particle.heights = gain;
    }
    weights.push_back(weight);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  const int before = size();
  const double of_new = before * something_new * exact_.probability(LabelModel::kInside, true);
  if (touch.on && 2.0 * of_new > of_label) new_until_ = touches_.size() + kNew;
  resample(weights, sum, count());
  if (touch.on && something_new > 0.0) find(number, unseen, something_new);
  unseen_.add(touch, labels(settings_.blur > 0.0));
  const int moves = this->moves(sum * sum / (sum_of_squares * before));
  for (Particle& particle : particles_) {
    proposal_.begin(particle);
    for (int i = 0; i < moves; ++i) move(particle);
  }
  held_.reset();
  constexpr std::size_t kAsked = 8;
  std::vector<const Outline*> asked;
  for (std::size_t k = 0; k < kAsked; ++k) asked.push_back(&particles_[k * particles_.size() / kAsked].outline);
  unseen_.lie_apart_from(asked);
  return of_label / before;
}

/// What was just found may be of any kind, and a kind that no outline has by then is hardly thought of again.
std::size_t Particles::count() const {
  return static_cast<std::size_t>(touches_.size() < new_until_ ? 2 * settings_.count : settings_.count);
}

/// Of each outline after a touch of which the label left such a share of them.
int Particles::moves(double left) const {
  const Target& here = touches_.back().place;
  double forms = 0.0;
  for (const Particle& particle : particles_) {
    double elsewhere = 0.0;
    for (const Piece& piece : particle.outline) (piece.near(here) ? forms : elsewhere) += piece.hollow ? 2.0 : 1.0;
    forms += std::min(elsewhere, kElsewhere);
  }
  const double each = settings_.moves + settings_.moves_apart * (1.0 / left - 1.0);
  return std::min(settings_.most_moves, static_cast<int>(std::ceil(std::max(1.0, forms / size()) * each)));
}

/// Of what was not seen so far, what holds the touch is seen now: a piece, as often as it was there to be found.
void Particles::find(std::size_t number, const Unseen::Holding& unseen, double something_new) {
  for (Particle& particle : particles_) {
    if (particle.outline.size() >= prior_.settings().most) continue;
    const LabelModel& labels = this->labels(particle.blurred);
    const double found = something_new * labels.probability(LabelModel::kInside, true);
    const double known = (1.0 - something_new) * labels.probability(particle.depths.deepest()[number], true);
    if (random_.uniform() * (found + known) >= found) continue;
    Depths& depths = particle.depths;
    const int one = particle.outline.size();
    particle.outline.add(unseen.draw(random_));
    seen_after(particle.push).steps(particle.outline[one], labels, depths.row(one));
    deepest_of(depths.rows().data(), one + 1, places_.length(), depths.deepest());
    weigh_again(particle);
  }
}

void Particles::weigh_again(Particle& particle) {
  const LabelModel& labels = this->labels(particle.blurred);
  particle.mistakes = 0;
  particle.labels = 0.0;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const LabelModel::Step deepest = particle.depths.deepest()[i];
    particle.mistakes += labels.mistake(deepest, touches_[i].on) ? 1 : 0;
    particle.labels += labels.loss(deepest, touches_[i].on);
  }
  particle.heights = evidence(particle.depths.rows().data(), particle.outline.size());
}

/// Systematic resampling: one draw, and each outline comes as often as its weight says but for less than one. Those
/// that come stay where they are, and further copies take the places of those that do not: whole, or what the touch
/// tells of.
void Particles::resample(const std::vector<double>& weights, double sum, std::size_t count) {
  const double step = sum / static_cast<double>(count);
  const double first = random_.uniform() * step;
  particles_.resize(std::max(count, weights.size()));
  std::vector<int> times(particles_.size(), 0);
  std::size_t from = 0;
  double reached = weights.front();
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted = first + static_cast<double>(i) * step;
    while (reached < wanted && from + 1 < weights.size()) reached += weights[++from];
    ++times[from];
  }
  // Outlines that are drawn no more, those that have a blur and those that have none, the first ones last.
  std::array<std::vector<std::size_t>, 2> free;
  for (std::size_t i = particles_.size(); i-- > 0;) {
    if (times[i] == 0) free[particles_[i].blurred ? 1 : 0].push_back(i);
  }
  const auto next_free = [&](bool blurred) -> Particle& {
    std::vector<std::size_t>& alike = free[blurred ? 1 : 0];
    std::vector<std::size_t>& chosen = alike.empty() ? free[blurred ? 0 : 1] : alike;
    const std::size_t one = chosen.back();
    chosen.pop_back();
    return particles_[one];
  };
  const Target& here = touches_.back().place;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Particle& one = particles_[i];
    for (int more = times[i]; more > 1; --more) {
      Particle& other = next_free(one.blurred);
      if (take_over(one, here, objects_.data(), prior_.settings().most, other)) {
        weigh_again(other);
      } else {
        other = one;
      }
    }
  }
  // Where they are fewer, those behind move forward.
  for (std::size_t i = count; i < particles_.size(); ++i) {
    if (times[i] > 0) next_free(particles_[i].blurred) = std::move(particles_[i]);
  }
  particles_.resize(count);
}

void Particles::move(Particle& particle) {
  ++tried_;
  const double changes_blur = settings_.blur > 0.0 ? kBlurMoves : 0.0;
  const double pushes = settings_.pushes > 0.0 && touches_.size() > 1 ? kPushMoves : 0.0;
  Proposal& proposal = proposal_;
  bool blurred = particle.blurred;
  const double which = random_.uniform();
  if (which < changes_blur) {
    blurred = !blurred;
    proposal.until = places_.size();
    proposal.correction = 1.0;
  } else if (which < changes_blur + pushes) {
    propose_push(proposal, prior_, places_.size(), settings_.pushes, random_);
  } else {
    const double of_outline = (which - changes_blur - pushes) / (1.0 - changes_blur - pushes);
    propose(proposal, prior_, {seen_after(particle.push), objects_.data(), of_objects_}, of_outline, random_);
  }
  if (proposal.correction > 0.0 && weigh(particle, proposal, blurred)) ++moved_;
  proposal.begin_again(particle);
}

/// Metropolis and Hastings, in two steps, of which the first is quick: by the labels, then by the heights (delayed
/// acceptance: Christen and Fox 2005). Takes the proposal, or leaves the particle as it was.
bool Particles::weigh(Particle& particle, const Proposal& proposal, bool blurred) {
  const LabelModel& labels = this->labels(blurred);
  const LabelModel& labels_before = this->labels(particle.blurred);
  const double ratio = proposal.correction / (1.0 - random_.uniform());
  // So much more loss is allowed, at most: the logarithm itself is asked for last, where this does not tell.
  const double allowed = log_above(ratio);
  const double most = allowed + particle.labels;
  if (most < 0.0 || (particle.labels == 0.0 && ratio < 1.0)) return false;
  // Which pieces hold other touches than before, and of which touches that is asked.
  const Outline& outline = proposal.outline;
  const bool seen_otherwise = proposal.since < proposal.until;
  bool any_new = false;
  Places::Change change;
  change.outline = &outline;
  for (int i = 0; i < outline.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int was = proposal.was[at];
    any_new = any_new || was == Proposal::kNew;
    change.rows[at] = particle.depths.row(was);
    if (was != Proposal::kNew && !seen_otherwise) continue;
    change.rows[at] = change.to[static_cast<std::size_t>(change.changes)] = depths_.row(i);
    change.changed[static_cast<std::size_t>(change.changes++)] = i;
  }
  const auto down = [](int touch) { return touch & -Places::kWord; };
  const bool some = seen_otherwise && !any_new;
  change.since = some ? down(proposal.since) : 0;
  change.until = down((some ? proposal.until : places_.size()) + Places::kWord - 1);
  change.labels = &labels;
  change.labels_before = &labels_before;
  change.objects = objects_.data();
  change.deepest_before = particle.depths.deepest();
  change.deepest = depths_.deepest();
  if (!seen_after(proposal.push).weigh(change, most)) return false;
  const double more = change.loss - change.loss_before;
  if (more > allowed || (more > log_below(ratio) && more > math::log(ratio))) return false;
  const int length = places_.length();
  bool held_otherwise = outline.size() != particle.outline.size();
  for (int k = 0; k < change.changes; ++k) {
    LabelModel::Step* const row = change.to[static_cast<std::size_t>(k)];
    const LabelModel::Step* const before = particle.depths.row(change.changed[static_cast<std::size_t>(k)]);
    std::copy(before, before + change.since, row);
    std::copy(before + change.until, before + length, row + change.until);
    held_otherwise = held_otherwise || differ_in_holding(row, before, objects_.data(), length);
  }
  double heights = particle.heights;
  if (held_otherwise) {
    // A piece that holds no touch of an object would be one that was not seen.
    if (!all_touched(change.rows.data(), outline.size())) return false;
    heights = evidence(change.rows.data(), outline.size());
    if (heights < particle.heights && math::log(1.0 - random_.uniform()) > heights - particle.heights) return false;
  }
  particle.mistakes += change.mistakes;
  particle.labels += more;
  particle.heights = heights;
  particle.blurred = blurred;
  proposal.take(particle);
  for (int i = 0; i < outline.size(); ++i) {
    const LabelModel::Step* const row = change.rows[static_cast<std::size_t>(i)];
    if (row != particle.depths.row(i)) std::copy_n(row, length, particle.depths.row(i));
  }
  if (change.labelled_otherwise)
    std::copy(change.deepest + change.since, change.deepest + change.until, particle.depths.deepest() + change.since);
  return true;
}

}  // namespace palpate::footprints
