// SPDX-License-Identifier: MIT
#include "particles.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cmath>

namespace palpate::footprints {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// Standard normal (Box and Muller 1958).
double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(kTwoPi * random.uniform());
}

}  // namespace

Particles::Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random)
    : prior_(prior),
      settings_(settings),
      random_(random),
      log_odds_(std::log((1.0 - settings.mistaken) / settings.mistaken)) {
  outlines_.reserve(static_cast<std::size_t>(settings.count));
  for (int i = 0; i < settings.count; ++i) outlines_.push_back(draw());
}

Outline Particles::draw() {
  // An outline is drawn until it fits: that is what the prior says. The smallest fit nearly always where any do.
  constexpr int kPatience = 100000;
  const double range = std::log(prior_.largest / prior_.smallest);
  for (int tries = 0; tries < kPatience; ++tries) {
    Outline out;
    out.family = random_.uniform() < prior_.ellipses ? Outline::Family::ellipse : Outline::Family::box;
    const double one = 0.5 * prior_.smallest * std::exp(range * random_.uniform());
    const double two = 0.5 * prior_.smallest * std::exp(range * random_.uniform());
    out.a = std::max(one, two);
    out.b = std::min(one, two);
    out.angle = 0.5 * kTwoPi * random_.uniform();
    out.x = prior_.area.width * random_.uniform();
    out.y = prior_.area.depth * random_.uniform();
    if (possible(out)) return out;
  }
  throw Error("footprint", "no outline of this prior fits into the area", "make footprint.smallest smaller");
}

bool Particles::possible(const Outline& outline) const {
  if (2.0 * outline.b < prior_.smallest || 2.0 * outline.a > prior_.largest) return false;
  if (outline.a > prior_.most_slender * outline.b) return false;
  return Region(outline).within({prior_.area.width, prior_.area.depth});
}

int Particles::mistakes(const Region& region) const {
  int out = 0;
  for (const Label& label : labels_) out += region.contains(label.place.x, label.place.y) != label.on ? 1 : 0;
  return out;
}

double Particles::mean_mistakes() const {
  double sum = 0.0;
  for (const Outline& outline : outlines_) sum += mistakes(Region(outline));
  return sum / static_cast<double>(outlines_.size());
}

double Particles::add(const Target& place, bool on) {
  labels_.push_back({place, on});
  std::vector<double> weights;
  weights.reserve(outlines_.size());
  double sum = 0.0;
  for (const Outline& outline : outlines_) {
    const bool right = Region(outline).contains(place.x, place.y) == on;
    weights.push_back(right ? 1.0 - settings_.mistaken : settings_.mistaken);
    sum += weights.back();
  }
  resample(weights);
  for (std::size_t i = 0; i < outlines_.size(); ++i) move(i);
  return sum / static_cast<double>(outlines_.size());
}

/// Systematic resampling: one draw, and each outline comes as often as its weight says but for less than one.
void Particles::resample(const std::vector<double>& weights) {
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  const double step = sum / static_cast<double>(weights.size());
  const double first = random_.uniform() * step;
  std::vector<Outline> drawn;
  drawn.reserve(outlines_.size());
  std::size_t from = 0;
  double reached = weights.front();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double wanted = first + static_cast<double>(i) * step;
    while (reached < wanted && from + 1 < weights.size()) reached += weights[++from];
    drawn.push_back(outlines_[from]);
  }
  outlines_.swap(drawn);
}

void Particles::move(std::size_t which) {
  Outline& outline = outlines_[which];
  int wrong = mistakes(Region(outline));
  for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
    ++tried_;
    Outline other = outline;
    const double preference = propose(other);
    if (preference <= 0.0 || !possible(other)) continue;
    const int other_wrong = mistakes(Region(other));
    // Metropolis and Hastings: likelihood ratio and preference.
    const double log_ratio = (wrong - other_wrong) * log_odds_ + std::log(preference);
    if (log_ratio < 0.0 && random_.uniform() >= std::exp(log_ratio)) continue;
    outline = other;
    wrong = other_wrong;
    ++moved_;
  }
}

double Particles::propose(Outline& o) {
  constexpr double kShift = 0.04;                   // metres
  constexpr double kTurn = 0.8;                     // radians
  constexpr double kStretch = 0.5;                  // of a logarithm
  constexpr double kLogScales = 3.45;               // steps of all sizes down to a thirtieth
  constexpr double kSameArea = 1.1283791670955126;  // an ellipse of a box's area is longer by this
  const double scale = std::exp(-kLogScales * random_.uniform());
  const double kind = random_.uniform();
  double preference = 1.0;
  if (kind < 0.02) {
    o = draw();  // by the prior, which then cancels
    return 1.0;
  }
  if (kind < 0.4) {
    o.x += kShift * scale * normal(random_);
    o.y += kShift * scale * normal(random_);
  } else if (kind < 0.6) {
    o.angle += kTurn * scale * normal(random_);
  } else if (kind < 0.8) {
    o.a *= std::exp(kStretch * scale * normal(random_));
    o.b *= std::exp(kStretch * scale * normal(random_));
  } else if (kind < 0.97) {
    // One side moves, the one across from it stays.
    const bool along = random_.uniform() < 0.5;
    double& half = along ? o.a : o.b;
    const double before = half;
    const double change = 0.5 * kShift * scale * normal(random_);
    half += change;
    if (half <= 0.0) return 0.0;
    const double side = random_.uniform() < 0.5 ? change : -change;
    const double c = std::cos(o.angle);
    const double s = std::sin(o.angle);
    o.x += side * (along ? c : -s);
    o.y += side * (along ? s : c);
    preference = before / half;  // uniform in logarithms: shorter ones weigh more
  } else {
    const bool ellipse = o.family == Outline::Family::box;
    if (prior_.ellipses <= 0.0 || prior_.ellipses >= 1.0) return 0.0;
    o.family = ellipse ? Outline::Family::ellipse : Outline::Family::box;
    o.a *= ellipse ? kSameArea : 1.0 / kSameArea;
    o.b *= ellipse ? kSameArea : 1.0 / kSameArea;
    const double odds = prior_.ellipses / (1.0 - prior_.ellipses);
    preference = ellipse ? odds : 1.0 / odds;
  }
  if (o.b > o.a) {
    std::swap(o.a, o.b);
    o.angle += 0.25 * kTwoPi;
  }
  return preference;
}

void Particles::count_inside(const PointsView& places, int columns, VectorOut inside) const {
  // A row of places is cut by a convex outline in one piece: where it begins and ends is marked, and summed up later.
  const auto rows = static_cast<int>(places.rows()) / columns;
  const double x0 = places(0, 0);
  const double step = columns > 1 ? (places(columns - 1, 0) - x0) / (columns - 1) : 1.0;
  const double y0 = places(0, 1);
  const double rise = rows > 1 ? (places((rows - 1) * columns, 1) - y0) / (rows - 1) : 1.0;
  Eigen::MatrixXd marks = Eigen::MatrixXd::Zero(columns + 1, rows);
  for (const Outline& outline : outlines_) {
    const Region region(outline);
    const int first = std::max(0, static_cast<int>(std::ceil((outline.y - region.reach_y() - y0) / rise)));
    const int last = std::min(rows - 1, static_cast<int>(std::floor((outline.y + region.reach_y() - y0) / rise)));
    for (int row = first; row <= last; ++row) {
      const auto [low, high] = region.cut(y0 + row * rise);
      if (low > high) continue;
      const int begin = std::max(0, static_cast<int>(std::ceil((low - x0) / step)));
      const int end = std::min(columns - 1, static_cast<int>(std::floor((high - x0) / step)));
      if (begin > end) continue;
      marks(begin, row) += 1.0;
      marks(end + 1, row) -= 1.0;
    }
  }
  for (int row = 0; row < rows; ++row) {
    double count = 0.0;
    for (int column = 0; column < columns; ++column) inside(row * columns + column) = count += marks(column, row);
  }
}

}  // namespace palpate::footprints
