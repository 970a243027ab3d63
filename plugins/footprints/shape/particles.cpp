// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace palpate::footprints {
namespace {

// Greatest steps; each is made smaller by a factor down to a thirtieth, for posteriors of all widths.
constexpr double kShift = 0.07;   // metres
constexpr double kTurn = 1.4;     // radians
constexpr double kStretch = 0.9;  // of a logarithm
constexpr int kScales = 16;

/// Factors of the steps, their logarithms evenly spaced: a look-up is quicker than a power.
double some_scale(Random& random) {
  static const std::array<double, kScales> scales = [] {
    std::array<double, kScales> out{};
    for (int i = 0; i < kScales; ++i) out[static_cast<std::size_t>(i)] = std::pow(1.0 / 30.0, i / (kScales - 1.0));
    return out;
  }();
  return scales[static_cast<std::size_t>(random.bits() % kScales)];
}

/// The loss from which on a label counts as wrong: half of that of one which no blur explains.
constexpr double kMistake = 0.5;

constexpr double kNear = 0.03;  // metres: standard deviation, along x and y, of a new piece from a wrong label

/// Standard normal (Box and Muller 1958).
double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

/// Uniform in (-1, 1]: as good as a normal step where steps are of all sizes anyway, and quicker.
double either_way(Random& random) { return 1.0 - 2.0 * random.uniform(); }

/// Moves a side and leaves the one across from it. Returns the correction: even steps in the length of a half axis are
/// uneven ones in its logarithm.
double move_side(Piece& piece, double scale, Random& random) {
  const bool along = random.uniform() < 0.5;
  double& half = along ? piece.a : piece.b;
  const double before = half;
  const double change = 0.5 * kShift * scale * either_way(random);
  half += change;
  if (half <= 0.0) return 0.0;
  const double side = random.uniform() < 0.5 ? change : -change;
  piece.x += side * (along ? piece.cosine : -piece.sine);
  piece.y += side * (along ? piece.sine : piece.cosine);
  const double correction = before / half;
  piece.order_axes();
  return correction;
}

void change_family(Piece& piece) {
  constexpr double kSameExtent = 1.1283791670955126;  // an ellipse as large as a box is longer by this
  const bool box = piece.family == Piece::Family::box;
  piece.family = box ? Piece::Family::ellipse : Piece::Family::box;
  piece.a *= box ? kSameExtent : 1.0 / kSameExtent;
  piece.b *= box ? kSameExtent : 1.0 / kSameExtent;
}

/// The labels of one piece that a second piece of a kind could set right.
std::vector<Target> repairable(const Piece& piece, Outline::Kind kind, const std::vector<Touch>& touches) {
  std::vector<Target> out;
  const bool adds = kind == Outline::Kind::two;
  for (const Touch& touch : touches) {
    if (touch.on == adds && piece.contains(touch.place.x, touch.place.y) != adds) out.push_back(touch.place);
  }
  return out;
}

/// How much less often the centre of the second piece is proposed than the prior has it.
double second_correction(const Outline& outline, const OutlinePrior& prior, const std::vector<Target>& near) {
  if (near.empty()) return 1.0;
  const double by_prior = prior.second_centre_density(outline);
  double by_labels = 0.0;
  for (const Target& place : near) {
    const double dx = (outline.second.x - place.x) / kNear;
    const double dy = (outline.second.y - place.y) / kNear;
    by_labels += std::exp(-0.5 * (dx * dx + dy * dy));
  }
  by_labels /= 2.0 * kPi * kNear * kNear * static_cast<double>(near.size());
  return by_prior / (0.5 * by_prior + 0.5 * by_labels);
}

/// Adds or takes away the second piece, or names the two pieces the other way round.
double change_kind(Outline& outline, Outline::Kind kind, const OutlinePrior& prior, const std::vector<Touch>& touches,
                   Random& random) {
  if (outline.kind == Outline::Kind::two && kind != Outline::Kind::two) {
    std::swap(outline.first, outline.second);
    return 1.0;
  }
  const std::vector<Target> near = repairable(outline.first, kind, touches);
  if (outline.kind == kind) {
    const double correction = second_correction(outline, prior, near);
    outline.kind = Outline::Kind::one;
    return 1.0 / (prior.odds(kind) * correction);
  }
  if (outline.kind != Outline::Kind::one) return 0.0;
  outline.kind = kind;
  outline.second = prior.draw_second(kind, outline.first, random);
  if (!near.empty() && random.uniform() < 0.5) {
    const Target& place = near[random.index(near.size())];
    outline.second.x = place.x + kNear * normal(random);
    outline.second.y = place.y + kNear * normal(random);
  }
  return prior.odds(kind) * second_correction(outline, prior, near);
}

/// A changed outline, and what Metropolis and Hastings multiply the ratio of the likelihoods by: its prior density
/// times the density of proposing the way back, over those of the outline as it was and of the way there. 0 where there
/// is no way.
struct Proposal {
  Outline outline;
  double density = 0.0;  ///< of it, by the prior
  double correction = 0.0;
  Push push{};
};

/// Shifts, turns or stretches a piece, moves one of its sides, changes its family; adds a second piece or takes it away
/// again, or draws an outline anew. A second piece is added where the prior would have it or, one time in two, about a
/// label that the outline has wrong, because there it may set one right. `density` is that of `from`, by the prior.
Proposal propose(const Outline& from, double density, const Push& push, const OutlinePrior& prior,
                 const std::vector<Touch>& touches, Random& random) {
  Proposal out{from, density, 1.0, push};
  Outline& to = out.outline;
  const double which = random.uniform();
  if (which < 0.02) {
    to = prior.draw(random);
    out.density = prior.density(to);
    return out;
  }
  if (which < 0.14) {
    // As many of the moves add as take away, for each kind, so that these shares cancel.
    const auto kind = which < 0.08 ? Outline::Kind::two : Outline::Kind::without;
    out.correction = change_kind(to, kind, prior, touches, random);
    out.density = prior.density(to);
    if (out.density <= 0.0) out.correction = 0.0;
    return out;
  }

  Piece& piece = from.kind == Outline::Kind::one || random.uniform() < 0.5 ? to.first : to.second;
  const double scale = some_scale(random);
  if (which < 0.46) {
    piece.x += kShift * scale * either_way(random);
    piece.y += kShift * scale * either_way(random);
  } else if (which < 0.64) {
    piece.turn(kTurn * scale * either_way(random));
  } else if (which < 0.81) {
    piece.a *= std::exp(kStretch * scale * either_way(random));
    piece.b *= std::exp(kStretch * scale * either_way(random));
    piece.order_axes();
  } else if (which < 0.97) {
    out.correction = move_side(piece, scale, random);
  } else {
    change_family(piece);
  }
  out.density = out.correction > 0.0 ? prior.density(to) : 0.0;
  out.correction *= out.density / density;
  return out;
}

// How far a push goes: standard deviations along x and y, metres, and of the turn, radians.
constexpr double kPushed = 0.012;
constexpr double kTurned = 0.1;
constexpr double kPushMoves = 0.1;  // share of the moves

/// Of a push, up to a factor.
double density(const Push& push) {
  const double angle = push.angle() / kTurned;
  return std::exp(-0.5 * ((push.dx * push.dx + push.dy * push.dy) / (kPushed * kPushed) + angle * angle));
}

Push some_push(const Area& area, Random& random) {
  Push out;
  out.origin_x = 0.5 * area.width;
  out.origin_y = 0.5 * area.depth;
  out.dx = kPushed * normal(random);
  out.dy = kPushed * normal(random);
  const double angle = kTurned * normal(random);
  out.cosine = std::cos(angle);
  out.sine = std::sin(angle);
  return out;
}

/// Adds a push or takes it away, or changes it. Either the outline stays where it is now, or where it was before: then
/// what was touched before agrees with it as well as it did. `rate`: the prior probability of a push between two of
/// the `touches`, at least 2.
Proposal propose_push(const Particle& from, const OutlinePrior& prior, int touches, double rate, Random& random) {
  Proposal out{from.outline, from.density, 0.0, from.push};
  const bool stays_before = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    // A push that was found out late has been fitted over by then: one time in two it is looked for among the latest.
    constexpr int kLately = 6;
    const int lately = std::min(kLately, touches - 1);
    const auto odds = [&](int before) {
      return rate / (0.5 / (touches - 1) + (before >= touches - lately ? 0.5 / lately : 0.0));
    };
    if (from.push) {
      if (stays_before) out.outline = from.push.then(from.outline);
      out.push = Push();
      out.correction = 1.0 / odds(from.push.before);
    } else {
      out.push = some_push(prior.area(), random);
      const int among = random.uniform() < 0.5 ? lately : touches - 1;
      out.push.before = touches - 1 - static_cast<int>(random.index(static_cast<std::size_t>(among)));
      if (stays_before) out.outline = out.push.now(from.outline);
      out.correction = odds(out.push.before);
    }
  } else {
    if (!from.push) return out;
    if (random.uniform() < 0.25) {
      constexpr int kFar = 3;
      out.push.before += static_cast<int>(random.index(2 * kFar + 1)) - kFar;
      if (out.push.before < 1 || out.push.before >= touches) return out;
    } else {
      const double scale = some_scale(random);
      out.push.dx += 2.0 * kPushed * scale * either_way(random);
      out.push.dy += 2.0 * kPushed * scale * either_way(random);
      const double angle = from.push.angle() + 2.0 * kTurned * scale * either_way(random);
      out.push.cosine = std::cos(angle);
      out.push.sine = std::sin(angle);
      if (stays_before) out.outline = out.push.now(from.push.then(from.outline));
    }
    out.correction = density(out.push) / density(from.push);
  }
  out.density = prior.density(out.outline);
  out.correction *= out.density / from.density;
  return out;
}

/// Whole numbers from `begin` on, before `end`; none where that is not above `begin`.
struct Cells {
  int begin;
  int end;
};

/// Places along one axis, in equal steps.
struct Axis {
  double first;
  double step;
  int count;

  Axis(double from, double to, int places)
      : first(from), step(places > 1 ? (to - from) / (places - 1) : 1.0), count(places) {}

  double at(int i) const { return first + i * step; }
  /// Those of them between two ends, in steps from the first.
  Cells within(double low, double high) const { return {not_below(low), std::min(count, above(high))}; }

 private:
  /// The first whole number that is not below `t`, none of them negative, and the first above it. (Without SSE4.1
  /// std::ceil and std::floor are calls.)
  static int not_below(double t) { return t <= 0.0 ? 0 : above(t) - (static_cast<double>(above(t) - 1) == t ? 1 : 0); }
  static int above(double t) { return t < 0.0 ? 0 : static_cast<int>(t) + 1; }
};

/// How many outlines hold each place of a lattice: where a row of them begins and ends is marked, and the marks are
/// summed up in the end.
class LatticeCounts {
 public:
  /// None where the places are no lattice, row after row in equal steps up.
  static std::optional<LatticeCounts> over(const PointsView& places) {
    const auto count = static_cast<int>(places.rows());
    int columns = 1;
    while (columns < count && places(columns, 1) == places(0, 1)) ++columns;
    if (count == 0 || count % columns != 0) return std::nullopt;
    const Axis x(places(0, 0), places(columns - 1, 0), columns);
    const Axis y(places(0, 1), places(count - columns, 1), count / columns);
    // Steps that are all but rounding are those of nearly equal places.
    constexpr double kLeast = 1e-6;  // metres
    if (x.step < kLeast || y.step < kLeast) return std::nullopt;
    for (int i = 0; i < count; ++i) {
      const double off_x = places(i, 0) - x.at(i % columns);
      const double off_y = places(i, 1) - y.at(i / columns);
      if (std::abs(off_x) > kLeast * x.step || std::abs(off_y) > kLeast * y.step) return std::nullopt;
    }
    return LatticeCounts(x, y);
  }

  void add(const Outline& outline) {
    const Cuts first = Cuts(outline.first).scaled(x_.first, x_.step, y_.first, y_.step);
    if (outline.kind == Outline::Kind::one) {
      const Cells rows = rows_of(first);
      for (int row = rows.begin; row < rows.end; ++row) mark(row, cells(first, row), 1.0);
      return;
    }
    const Cuts second = Cuts(outline.second).scaled(x_.first, x_.step, y_.first, y_.step);
    const Cells of_first = rows_of(first);
    const Cells of_second = rows_of(second);
    for (int row = of_first.begin; row < of_first.end; ++row) mark(row, cells(first, row), 1.0);
    // What both hold is counted once if they are united, and not at all if one is taken from the other.
    for (int row = std::max(of_first.begin, of_second.begin); row < std::min(of_first.end, of_second.end); ++row) {
      const Cells a = cells(first, row);
      const Cells b = cells(second, row);
      mark(row, {std::max(a.begin, b.begin), std::min(a.end, b.end)}, -1.0);
    }
    if (outline.kind != Outline::Kind::two) return;
    for (int row = of_second.begin; row < of_second.end; ++row) mark(row, cells(second, row), 1.0);
  }

  void sum(VectorOut out) const {
    for (int row = 0; row < y_.count; ++row) {
      double count = 0.0;
      for (int column = 0; column < x_.count; ++column) out(row * x_.count + column) = count += marks_(column, row);
    }
  }

 private:
  LatticeCounts(const Axis& x, const Axis& y) : x_(x), y_(y), marks_(Eigen::MatrixXd::Zero(x.count + 1, y.count)) {}

  // Cuts in steps of the lattice, from its first place on.
  Cells rows_of(const Cuts& cuts) const { return y_.within(cuts.y() - cuts.reach(), cuts.y() + cuts.reach()); }
  Cells cells(const Cuts& cuts, int row) const {
    const auto [low, high] = cuts.at(row);
    return low > high ? Cells{0, 0} : x_.within(low, high);
  }

  void mark(int row, const Cells& cells, double sign) {
    if (cells.begin >= cells.end) return;
    marks_(cells.begin, row) += sign;
    marks_(cells.end, row) -= sign;
  }

  Axis x_, y_;
  Eigen::MatrixXd marks_;
};

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
    particles_.push_back({outline, prior_.density(outline), 0, 0.0, false, {}});
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
      changes_blur ? Proposal{particle.outline, particle.density, 1.0, particle.push}
      : pushes     ? propose_push(particle, prior_, static_cast<int>(touches_.size()), settings_.pushes, random_)
                   : propose(particle.outline, particle.density, particle.push, prior_, touches_, random_);
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
  particle = {proposal.outline, proposal.density, mistakes, loss, blurred, proposal.push};
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
