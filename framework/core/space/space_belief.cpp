// SPDX-License-Identifier: MIT
#include "space/space_belief.hpp"

#include "experiment/policy.hpp"
#include "space/reduction.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Tools come level or from above, or from below by no more than 30 degrees.
constexpr double kSteepestUp = 0.5;

/// Of every two approaches the first goes anywhere, the second along a normal, where there is one.
bool goes_anywhere(std::size_t approach) { return approach % 2 == 0; }

SolidsSettings settings_of(const SpaceOptions& options) {
  SolidsSettings out;
  out.count = static_cast<int>(options.particles);
  out.moves = static_cast<int>(options.moves);
  out.misfit = options.model_discrepancy;
  return out;
}

/// Metres below the desk at which a tool that presses on it is felt by all means.
constexpr double kFeltLate = 0.03;

/// Nats that a touch costs at most once contacts are known to err: less than a piece that floats, so that one contact
/// in the air makes none. Two in a hundred that are a lie, anywhere on the way, are about as much.
constexpr double kLie = 6.5;

// Marks in hex: SpaceBelief::unreached().
constexpr std::string_view kHexDigits = "0123456789abcdef";

std::size_t bit_of(std::size_t line) { return std::size_t{8} >> line % 4; }

bool is_marked(const std::string& marks, std::size_t line) {
  return line / 4 < marks.size() && (kHexDigits.find(marks[line / 4]) & bit_of(line)) != 0;
}

void mark(std::string& marks, std::size_t line) {
  marks.resize(std::max(marks.size(), line / 4 + 1), kHexDigits[0]);
  marks[line / 4] = kHexDigits[kHexDigits.find(marks[line / 4]) | bit_of(line)];
}

/// A tool's tip is a tool's, whoever moves it.
double tip_of(const Scene& scene) { return scene.effects().tip_radius ? scene.effects().tip_radius->radius : 0.0; }

}  // namespace

Region::Region(const Area& area, double desk) {
  constexpr double kShare = 0.46;  // of the longer side: objects lie anywhere along it
  constexpr double kHeight = 0.65;
  radius = kShare * std::max(area.width, area.depth);
  centre = {area.width / 2, area.depth / 2, desk + kHeight * radius};
}

SpaceBelief::SpaceBelief(const ExperimentOptions& options, const Context& context, const Backend& backend)
    : context_(context),
      backend_(backend),
      region_(context.scene.area(), 0.0),
      desk_(context.scene.desk()),
      count_(static_cast<std::size_t>(options.space->approaches)),
      solids_(context.scene.area(), settings_of(*options.space), context.random("space/solids")),
      skin_(context.create<Kernel>(options.kernel), SkinSettings{options.height.signal, options.height.noise}),
      misfit_(options.space->model_discrepancy),
      noise_(options.height.noise),
      overtravel_(tip_of(context.scene), options.scene.min_object_height) {
  draw_approaches();
}

double SpaceBelief::meeting(const Approach& approach, const Composition& composition) const {
  const Line line = line_of(approach);
  return std::max(0.0, std::min({approach.length, distance_down_to(0.0, line), composition.first_intersection(line)}));
}

void SpaceBelief::look(const std::vector<SurfaceTouch>& seen) {
  touches_ = seen;
  seen_ = seen.size();
}

void SpaceBelief::observe(const Approach& approach, const Contact& contact) {
  ++taps_;
  if (contact.outcome != Outcome::contact && contact.outcome != Outcome::no_contact) return;
  const Told one = told(approach, contact);
  // A tool that felt nothing of the desk would have felt nothing of an object either.
  if (!one.touch.contact && one.touch.end().z() < -kFeltLate) return;
  told_.push_back(one);
  const double before = overtravel_.spread();
  overtravel_.add(one.touch, one.force);
  read_again_ = read_again_ || overtravel_.spread() != before;
  for (std::size_t i = 0; i < told_.size(); ++i) {
    const SurfaceTouch touch = overtravel_.read(told_[i].touch, told_[i].force);
    if (i + 1 == told_.size()) {
      touches_.push_back(touch);
      continue;
    }
    SurfaceTouch& known = touches_[seen_ + i];
    read_again_ = read_again_ || touch.length != known.length || touch.desk != known.desk;
    known = touch;
  }
}

SpaceBelief::Told SpaceBelief::told(const Approach& approach, const Contact& contact) const {
  SurfaceTouch touch;
  touch.line = line_of(approach);
  touch.length = contact.along.value_or(approach.length);
  touch.contact = contact.outcome == Outcome::contact;
  return {touch, contact.force, taps_, touch.contact && !overtravel_.read(touch, contact.force).desk};
}

SpaceBelief::Hits SpaceBelief::hits() const {
  Hits out;
  for (std::size_t i = 0; i < told_.size(); ++i) {
    const SurfaceTouch& touch = touches_[seen_ + i];
    if (!touch.contact || touch.desk) continue;
    ++out.count;
    if (!out.first) out.first = told_[i].tap;
  }
  return out;
}

std::vector<Relabelled> SpaceBelief::relabelled() const {
  std::vector<Relabelled> out;
  for (std::size_t i = 0; i < told_.size(); ++i) {
    const SurfaceTouch& touch = touches_[seen_ + i];
    const bool on_object = touch.contact && !touch.desk;
    if (on_object != told_[i].on_object) out.push_back({told_[i].tap, on_object});
  }
  return out;
}

bool SpaceBelief::on_object(const Approach& approach, const Contact& contact) const {
  return told(approach, contact).on_object;
}

void SpaceBelief::update(Quantities reads) {
  if (taken_in_ < seen_) {
    solids_.look({touches_.begin(), touches_.begin() + static_cast<std::ptrdiff_t>(seen_)});
    taken_in_ = seen_;
  }
  if (read_again_) {
    // A touch errs by what the solids are off the objects, and by what it is told wrongly.
    const double spread = overtravel_.spread() > Overtravel::kLeastSpread ? overtravel_.spread() : 0.0;
    solids_.read_again({touches_.begin(), touches_.begin() + static_cast<std::ptrdiff_t>(taken_in_)},
                       math::hypot(misfit_, spread), kLie);
    skin_.set_noise(std::max(noise_, spread));
    read_again_ = false;
  }
  for (; taken_in_ < touches_.size(); ++taken_in_) solids_.add({touches_[taken_in_]});
  skin_.fit(solids_.best(), touches_);
  draw_approaches();
  if (reads == Quantities{}) return;
  look_where_met();
  if (reads.has(Quantity::deviation)) look_at_deviations();
  if (reads.has(Quantity::std_reduction)) look_for_reductions();
  if (reads.has(Quantity::expected_discovery)) look_for_unseen();
  require_finite(met_, "the way to the surface", taps_);
  require_finite(deviation_, "the deviation of the surface", taps_);
  require_finite(reduction_, "the reduction of the deviation", taps_);
  require_finite(unseen_, "the unseen", taps_);
}

/// Of the lines that come from where a tool may, all alike.
Line SpaceBelief::random_line(Random& random) const {
  while (true) {
    const double z = -1.0 + (1.0 + kSteepestUp) * random.uniform();
    const double angle = 2.0 * kHalfTurn * random.uniform();
    const double level = std::sqrt(1.0 - z * z);
    const Vector3d direction(level * math::cos(angle), level * math::sin(angle), z);
    const double away = region_.radius * std::sqrt(random.uniform());
    const double turn = 2.0 * kHalfTurn * random.uniform();
    const Vector3d aside = direction.unitOrthogonal();
    const Vector3d nearest =
        region_.centre + away * (math::cos(turn) * aside + math::sin(turn) * direction.cross(aside));
    const double back = std::sqrt(region_.outside() * region_.outside() - away * away);
    Line out{nearest - back * direction, direction};
    if (out.origin.z() > 0.0) return out;
  }
}

/// Straight onto the surface that is believed, where a line from outside meets it.
std::optional<Line> SpaceBelief::along_normal(Random& random) const {
  const Line line = random_line(random);
  const double hit = solids_.best().first_intersection(line);
  if (hit >= distance_down_to(0.0, line)) return std::nullopt;
  const Vector3d at = line.origin + hit * line.direction;
  const Vector3d inwards = -Skin::normal(solids_.best(), at);
  if (inwards.z() > kSteepestUp) return std::nullopt;
  const double towards = (region_.centre - at).dot(inwards);
  const double aside = (region_.centre - at).squaredNorm() - towards * towards;
  const double back = std::sqrt(std::max(0.0, region_.outside() * region_.outside() - aside)) - towards;
  Line out{at - back * inwards, inwards};
  return out.origin.z() > 0.0 ? std::optional(out) : std::nullopt;
}

int SpaceBelief::find(const Approach& approach) const {
  const auto at = std::find_if(approaches_.begin(), approaches_.end(), [&](const Approach& one) {
    return one.line.origin == approach.line.origin && one.line.direction == approach.line.direction;
  });
  return at != approaches_.end() ? static_cast<int>(at - approaches_.begin()) : 0;
}

void SpaceBelief::draw_approaches() {
  // A stream a tap: what is drawn depends on the touches alone, and a resumed run draws the same.
  Random random = context_.random("space/approaches", static_cast<std::uint64_t>(taps_));
  approaches_.clear();
  unreached_.clear();
  const auto recalled = recalled_.find(taps_ + 1);
  constexpr std::size_t kTries = 20;
  for (std::size_t tries = 0; approaches_.size() < count_; ++tries) {
    if (tries == kTries * count_) {
      throw Error("backend", "rejects every tap from any side that was tried",
                  "use scene.touch: top for an arm that taps from above");
    }
    std::optional<Line> line;
    if ((taps_ > 0 || seen_ > 0) && !goes_anywhere(approaches_.size())) line = along_normal(random);
    if (!line) line = random_line(random);
    const Approach approach{{line->origin + Vector3d(0.0, 0.0, desk_), line->direction}, 2.0 * region_.outside()};
    const bool refused = recalled != recalled_.end() ? is_marked(recalled->second, tries) : !backend_.reaches(approach);
    if (refused) {
      mark(unreached_, tries);
    } else {
      approaches_.push_back(approach);
    }
  }
}

Line SpaceBelief::line_of(const Approach& approach) const {
  return {approach.line.origin - Vector3d(0.0, 0.0, desk_), approach.line.direction};
}

void SpaceBelief::look_where_met() {
  const auto count = static_cast<Eigen::Index>(approaches_.size());
  met_.resize(count);
  incidence_cosine_ = Eigen::VectorXd::Zero(count);
  places_.clear();
  meets_.clear();
  const Composition& best = solids_.best();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Approach& approach = approaches_[static_cast<std::size_t>(i)];
    const Line line = line_of(approach);
    const double hit = best.first_intersection(line);
    met_(i) = std::min({hit, approach.length, distance_down_to(0.0, line)});
    if (hit > met_(i)) continue;
    const Vector3d at = line.origin + hit * line.direction;
    const Vector3d normal = Skin::normal(best, at);
    places_.push_back({at, normal});
    meets_.push_back(i);
    incidence_cosine_(i) = std::min(1.0, std::abs(normal.dot(line.direction)));
  }
}

void SpaceBelief::look_at_deviations() {
  const Skin::Posterior posterior = skin_.posterior(places_);
  deviation_ = Eigen::VectorXd::Zero(met_.size());
  deviation_(meets_) = posterior.variance.cwiseSqrt();
  clamped_ = posterior.clamped;
}

void SpaceBelief::look_for_reductions() {
  constexpr std::size_t kMost = 300;
  constexpr double kSquarely = 0.5;
  const Representatives some = representatives(places_, kMost);
  reduced_.redundant_taps = 0;  // as it is now
  const Eigen::VectorXd reductions = expected_reductions(solids_, skin_, some.places, &reduced_);
  reduction_ = Eigen::VectorXd::Zero(met_.size());
  for (std::size_t i = 0; i < meets_.size(); ++i) {
    if (incidence_cosine_(meets_[i]) > kSquarely)
      reduction_(meets_[i]) = reductions(static_cast<Eigen::Index>(some.stands_for[i]));
  }
}

FactorReport SpaceBelief::factors() const {
  FactorReport out = skin_.report();
  out.jitter *= skin_.deviation() * skin_.deviation();
  out.add(reduced_);
  return out;
}

void SpaceBelief::look_for_unseen() {
  constexpr int kDraws = 1000;
  constexpr double kClearly = 0.003;  // earlier than what is believed
  constexpr double kFarthest = 0.03;  // that a line counts
  unseen_ = Eigen::VectorXd::Zero(met_.size());
  Random random = context_.random("space/unseen", static_cast<std::uint64_t>(taps_));
  const std::vector<Piece> pieces = solids_.unseen(solids_.best(), kDraws, random);
  double anywhere = 0.0;
  const auto count = static_cast<Eigen::Index>(approaches_.size());
  Eigen::ArrayX3d origin(count, 3), direction(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Line line = line_of(approaches_[static_cast<std::size_t>(i)]);
    origin.row(i) = line.origin;
    direction.row(i) = line.direction;
    anywhere += goes_anywhere(static_cast<std::size_t>(i)) ? 1.0 : 0.0;
  }
  std::vector<Eigen::Index> meets;
  Eigen::ArrayXd along(count), aside(count);
  for (const Piece& piece : pieces) {
    // Most lines pass by the ball around the piece, or end before it.
    const double radius = piece.half.norm();
    const auto apart = [&](Eigen::Index k) { return piece.centre(k) - origin.col(k); };
    along = apart(0) * direction.col(0) + apart(1) * direction.col(1) + apart(2) * direction.col(2);
    aside = apart(0).square() + apart(1).square() + apart(2).square() - along.square();
    meets.clear();
    double moves = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (aside(i) > radius * radius || along(i) - radius > met_(i)) continue;
      const double earlier =
          met_(i) - piece.first_intersection({origin.row(i).transpose(), direction.row(i).transpose()});
      if (earlier <= kClearly) continue;
      meets.push_back(i);
      if (goes_anywhere(static_cast<std::size_t>(i))) moves += std::min(kFarthest, earlier);
    }
    // The mean over the lines from all sides.
    moves /= anywhere * kDraws;
    for (const Eigen::Index i : meets) unseen_(i) += moves;
  }
}

Eigen::VectorXd SpaceBelief::uncertainty(const Cloud& surface) const {
  Skin::Places places;
  for (const Vector3d& at : surface) places.push_back({at, Skin::normal(solids_.best(), at)});
  Eigen::VectorXd squares = skin_.posterior(places).variance;
  require_finite(squares, "the variance of the surface", taps_);
  const auto compositions = static_cast<double>(solids_.compositions().size());
  for (std::size_t i = 0; i < surface.size(); ++i)
    squares(static_cast<Eigen::Index>(i)) += solids_.offsets(surface[i]).squaredNorm() / compositions;
  return squares.cwiseSqrt();
}

Cloud SpaceBelief::surface(const Bundle& bundle, double side) const {
  const Composition& best = solids_.best();
  Cloud points;
  for (const Line& line : bundle.lines) {
    const double hit = best.first_intersection(line);
    if (hit < distance_down_to(0.0, line)) points.emplace_back(line.origin + hit * line.direction);
  }
  Skin::Places places;
  for (const Vector3d& at : thinned(points, side)) places.push_back({at, Skin::normal(best, at)});
  const Eigen::VectorXd means = skin_.means(places);
  require_finite(means, "the surface", taps_);
  Cloud out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Vector3d moved = places[i].at + means(static_cast<Eigen::Index>(i)) * places[i].normal;
    moved.z() = std::max(0.0, moved.z());  // the desk is known, nothing is below it
    out.push_back(moved);
  }
  return out;
}

}  // namespace palpate
