// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::footprints {
namespace {

/// The places of a lattice that rows of pieces hold, counted: where a row of them begins and ends is marked, and the
/// marks are summed up in the end.
class LatticeCounts {
 public:
  LatticeCounts(const PointsView& places, int columns)
      : columns_(columns),
        rows_(static_cast<int>(places.rows()) / columns),
        x0_(places(0, 0)),
        step_(columns > 1 ? (places(columns - 1, 0) - x0_) / (columns - 1) : 1.0),
        y0_(places(0, 1)),
        rise_(rows_ > 1 ? (places((rows_ - 1) * columns, 1) - y0_) / (rows_ - 1) : 1.0),
        marks_(Eigen::MatrixXd::Zero(columns + 1, rows_)) {}

  void add(const Outline& outline) {
    const Cells rows = rows_of(outline.first);
    if (outline.kind == Outline::Kind::one) {
      for (int row = rows.begin; row < rows.end; ++row) mark(row, cut(outline.first, row), 1.0);
      return;
    }
    const Cells others = rows_of(outline.second);
    // What both hold is counted once if they are united, and not at all if one is taken from the other.
    for (int row = rows.begin; row < rows.end; ++row) {
      const Cells first = cut(outline.first, row);
      mark(row, first, 1.0);
      if (row < others.begin || row >= others.end) continue;
      const Cells second = cut(outline.second, row);
      mark(row, {std::max(first.begin, second.begin), std::min(first.end, second.end)}, -1.0);
    }
    if (outline.kind == Outline::Kind::without) return;
    for (int row = others.begin; row < others.end; ++row) mark(row, cut(outline.second, row), 1.0);
  }

  void sum(VectorOut out) const {
    for (int row = 0; row < rows_; ++row) {
      double count = 0.0;
      for (int column = 0; column < columns_; ++column) out(row * columns_ + column) = count += marks_(column, row);
    }
  }

 private:
  struct Cells {
    int begin;
    int end;  ///< one past the last; not above `begin` where there are none
  };

  /// The first whole number that is not below `t`, none of them negative, and the first above it. (Without SSE4.1
  /// std::ceil and std::floor are calls.)
  static int not_below(double t) { return t <= 0.0 ? 0 : above(t) - (static_cast<double>(above(t) - 1) == t ? 1 : 0); }
  static int above(double t) { return t < 0.0 ? 0 : static_cast<int>(t) + 1; }

  Cells rows_of(const Piece& piece) const {
    const double reach = piece.reach_y();
    return {not_below((piece.y - reach - y0_) / rise_), std::min(rows_, above((piece.y + reach - y0_) / rise_))};
  }

  Cells cut(const Piece& piece, int row) const {
    const auto [low, high] = piece.cut(y0_ + row * rise_);
    if (low > high) return {0, 0};
    return {not_below((low - x0_) / step_), std::min(columns_, above((high - x0_) / step_))};
  }

  void mark(int row, const Cells& cells, double sign) {
    if (cells.begin >= cells.end) return;
    marks_(cells.begin, row) += sign;
    marks_(cells.end, row) -= sign;
  }

  int columns_, rows_;
  double x0_, step_, y0_, rise_;
  Eigen::MatrixXd marks_;
};

}  // namespace

Particles::Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random)
    : prior_(prior),
      settings_(settings),
      random_(random),
      log_odds_(std::log((1.0 - settings.mistaken) / settings.mistaken)) {
  particles_.reserve(static_cast<std::size_t>(settings.count));
  for (int i = 0; i < settings.count; ++i) {
    const Outline outline = prior_.draw(random_);
    particles_.push_back({outline, prior_.density(outline)});
  }
}

double Particles::mean_mistakes() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.mistakes;
  return sum / static_cast<double>(particles_.size());
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
    const bool right = particle.outline.contains(touch.place.x, touch.place.y) == touch.on;
    if (!right) ++particle.mistakes;
    const double weight = right ? 1.0 - settings_.mistaken : settings_.mistaken;
    weights.push_back(weight);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  resample(weights);
  const auto count = static_cast<double>(particles_.size());
  const double left = sum * sum / (sum_of_squares * count);
  const int moves = std::min(settings_.most_moves, static_cast<int>(std::ceil(settings_.moves / left)));
  for (Particle& particle : particles_) {
    for (int i = 0; i < moves; ++i) move(particle);
  }
  return sum / count;
}

/// Systematic resampling: one draw, and each outline comes as often as its weight says but for less than one.
void Particles::resample(const std::vector<double>& weights) {
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
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
  const Proposal proposal = propose(particle.outline, particle.density, prior_, touches_, random_);
  if (!(proposal.correction > 0.0)) return;
  // Metropolis and Hastings: taken if a uniform number is below the ratio of the likelihoods times the correction. So
  // many mistakes are allowed, and most outlines are given up before all labels are looked at: the latest are the
  // nearest to the edge.
  const double allowed = particle.mistakes + std::log(proposal.correction / (1.0 - random_.uniform())) / log_odds_;
  if (allowed < 0.0) return;
  int mistakes = 0;
  for (auto touch = touches_.rbegin(); touch != touches_.rend(); ++touch) {
    mistakes += proposal.outline.contains(touch->place.x, touch->place.y) != touch->on ? 1 : 0;
    if (mistakes > allowed) return;
  }
  particle = {proposal.outline, proposal.density, mistakes};
  ++moved_;
}

void Particles::count_inside(const PointsView& places, int columns, VectorOut inside) const {
  LatticeCounts counts(places, columns);
  for (const Particle& particle : particles_) counts.add(particle.outline);
  counts.sum(inside);
}

}  // namespace palpate::footprints
