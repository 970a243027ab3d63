// SPDX-License-Identifier: MIT
#include "space/space_belief.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Tools come level or from above, or from below by no more than 30 degrees.
constexpr double kSteepestUp = 0.5;

SolidsSettings settings_of(const SpaceOptions& options) {
  SolidsSettings out;
  out.count = static_cast<int>(options.compositions);
  out.moves = static_cast<int>(options.moves);
  out.misfit = options.misfit;
  return out;
}

}  // namespace

Region::Region(const Area& area, double desk) {
  constexpr double kShare = 0.46;  // of the shorter side: an object has to fit in however it is turned
  constexpr double kHeight = 0.65;
  radius = kShare * std::min(area.width, area.depth);
  centre = {area.width / 2, area.depth / 2, desk + kHeight * radius};
}

SpaceBelief::SpaceBelief(const ExperimentOptions& options, const Context& context, const Backend& backend)
    : context_(context),
      backend_(backend),
      region_(context.scene.area(), 0.0),
      desk_(context.scene.desk()),
      count_(static_cast<std::size_t>(options.space->approaches)),
      solids_(context.scene.area(), settings_of(*options.space), context.random("space/solids")),
      skin_(context.create<Kernel>(options.kernel), SkinSettings{options.height.signal, options.height.noise}) {
  draw_approaches();
}

double SpaceBelief::desk_along(const Line& line) const {
  return line.direction.z() < 0.0 ? -line.origin.z() / line.direction.z() : kNoHit;
}

void SpaceBelief::observe(const Approach& approach, const Contact& contact) {
  ++taps_;
  if (contact.outcome != Outcome::contact && contact.outcome != Outcome::no_contact) return;
  SurfaceTouch touch;
  touch.line = {approach.line.origin - Vector3d(0.0, 0.0, desk_), approach.line.direction};
  touch.length = contact.along.value_or(approach.length);
  touch.contact = contact.outcome == Outcome::contact;
  constexpr double kOnDesk = 0.0015;
  touch.desk = touch.contact && touch.end().z() <= kOnDesk;
  touches_.push_back(touch);
}

void SpaceBelief::update(Quantities reads) {
  for (; taken_in_ < touches_.size(); ++taken_in_) solids_.add({touches_[taken_in_]});
  skin_.fit(solids_.best(), touches_);
  draw_approaches();
  if (reads.has(Quantity::meetings)) compare_compositions();
  if (reads.has(Quantity::deviation)) look_where_met();
}

/// Of the lines that come from where a tool may, all alike.
Line SpaceBelief::random_line(Random& random) const {
  while (true) {
    const double z = -1.0 + (1.0 + kSteepestUp) * random.uniform();
    const double angle = 2.0 * kHalfTurn * random.uniform();
    const double level = std::sqrt(1.0 - z * z);
    const Vector3d direction(level * std::cos(angle), level * std::sin(angle), z);
    const double away = region_.radius * std::sqrt(random.uniform());
    const double turn = 2.0 * kHalfTurn * random.uniform();
    const Vector3d aside = direction.unitOrthogonal();
    const Vector3d nearest = region_.centre + away * (std::cos(turn) * aside + std::sin(turn) * direction.cross(aside));
    const double back = std::sqrt(region_.outside() * region_.outside() - away * away);
    Line out{nearest - back * direction, direction};
    if (out.origin.z() > 0.0) return out;
  }
}

/// Straight onto the surface that is believed, where a line from outside meets it.
std::optional<Line> SpaceBelief::along_normal(Random& random) const {
  const Line line = random_line(random);
  const double hit = solids_.best().first_hit(line);
  if (hit >= desk_along(line)) return std::nullopt;
  const Vector3d at = line.origin + hit * line.direction;
  const Vector3d inwards = -Skin::normal(solids_.best(), at);
  if (inwards.z() > kSteepestUp) return std::nullopt;
  const double towards = (region_.centre - at).dot(inwards);
  const double aside = (region_.centre - at).squaredNorm() - towards * towards;
  const double back = std::sqrt(std::max(0.0, region_.outside() * region_.outside() - aside)) - towards;
  Line out{at - back * inwards, inwards};
  return out.origin.z() > 0.0 ? std::optional(out) : std::nullopt;
}

void SpaceBelief::draw_approaches() {
  // A stream a tap: what is drawn depends on the touches alone, and a resumed run draws the same.
  Random random = context_.random("space/approaches", static_cast<std::uint64_t>(taps_));
  approaches_.clear();
  constexpr std::size_t kTries = 20;
  for (std::size_t tries = 0; approaches_.size() < count_; ++tries) {
    if (tries == kTries * count_) {
      throw Error("backend", "makes no tap from any side that was tried",
                  "scene.touch: top is for arms that come from above");
    }
    std::optional<Line> line;
    if (taps_ > 0 && approaches_.size() % 2 == 1) line = along_normal(random);
    if (!line) line = random_line(random);
    const Approach approach{{line->origin + Vector3d(0.0, 0.0, desk_), line->direction}, 2.0 * region_.outside()};
    if (backend_.reaches(approach)) approaches_.push_back(approach);
  }
}

/// Beside what was touched there may be something that was not: half of the compositions are asked with a piece more.
void SpaceBelief::compare_compositions() {
  constexpr double kFarthest = 0.02;
  std::vector<Composition> all = solids_.compositions();
  Random random = context_.random("space/unseen", static_cast<std::uint64_t>(taps_));
  for (Composition& one : all) {
    if (random.uniform() < 0.5) continue;
    if (std::optional<Piece> more = solids_.unseen(one, random)) one.parts.push_back({*more, {}, {}, 0.0});
  }
  const auto rows = static_cast<Eigen::Index>(approaches_.size());
  const auto columns = static_cast<Eigen::Index>(all.size());
  meetings_.resize(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Approach& approach = approaches_[static_cast<std::size_t>(i)];
    const Line line{approach.line.origin - Vector3d(0.0, 0.0, desk_), approach.line.direction};
    const double end = std::min(approach.length, desk_along(line));
    for (Eigen::Index k = 0; k < columns; ++k)
      meetings_(i, k) = std::min(end, all[static_cast<std::size_t>(k)].first_hit(line));
  }
  differences_ = Eigen::MatrixXd::Zero(columns, columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    for (Eigen::Index j = 0; j < k; ++j) {
      differences_(k, j) = differences_(j, k) =
          (meetings_.col(k) - meetings_.col(j)).cwiseAbs().cwiseMin(kFarthest).mean();
    }
  }
}

void SpaceBelief::look_where_met() {
  const auto count = static_cast<Eigen::Index>(approaches_.size());
  deviation_ = Eigen::VectorXd::Zero(count);
  squareness_ = Eigen::VectorXd::Zero(count);
  const Composition& best = solids_.best();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Approach& approach = approaches_[static_cast<std::size_t>(i)];
    const Line line{approach.line.origin - Vector3d(0.0, 0.0, desk_), approach.line.direction};
    const double hit = best.first_hit(line);
    if (hit >= std::min(approach.length, desk_along(line))) continue;
    const Vector3d at = line.origin + hit * line.direction;
    const Vector3d normal = Skin::normal(best, at);
    deviation_(i) = std::sqrt(skin_.variance({at, normal}));
    squareness_(i) = std::min(1.0, std::abs(normal.dot(line.direction)));
  }
}

std::vector<SpaceBelief::SurfacePoint> SpaceBelief::surface(const Bundle& bundle, double side) const {
  const Composition& best = solids_.best();
  Cloud points;
  for (const Line& line : bundle.lines) {
    const double hit = best.first_hit(line);
    if (hit < desk_along(line)) points.emplace_back(line.origin + hit * line.direction);
  }
  std::vector<SurfacePoint> out;
  for (const Vector3d& at : thinned(points, side)) {
    const Skin::Place place{at, Skin::normal(best, at)};
    Vector3d moved = at + skin_.mean(place) * place.normal;
    moved.z() = std::max(0.0, moved.z());
    out.push_back({moved, place.normal, std::sqrt(skin_.variance(place))});
  }
  return out;
}

}  // namespace palpate
