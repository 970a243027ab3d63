// SPDX-License-Identifier: MIT
#include "solids/line_values.hpp"

#include "solids/reduction.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

Line LineValues::line(const SampledLines& lines, Eigen::Index index) const {
  const TapLine one = lines.lines.line(index);
  return {one.start - Eigen::Vector3d(0.0, 0.0, desk_), one.direction};
}

void LineValues::compute(const SampledLines& lines, const Solids& solids, const ResidualGp& residual_gp,
                         const QuantitySet& reads, Random random) {
  using namespace quantity;
  const auto has = [&](const char* name) { return reads.count(name) != 0; };
  const bool deviations = has(kSurfaceStd) || has(kMeasurementStd) || has(kUncertainty);
  find_contacts(lines, solids.best());
  for (Eigen::VectorXd* const old : {&surface_std_, &uncertainty_, &std_reduction_, &expected_discovery_})
    old->resize(0);
  if (deviations) compute_deviations(residual_gp);
  if (has(kStdReduction)) compute_reductions(solids, residual_gp);
  if (has(kExpectedDiscovery)) compute_discovery(lines, solids, random);
}

const Eigen::VectorXd* LineValues::find(std::string_view quantity) const {
  using namespace quantity;
  if (quantity == kExpectedDistance) return &distance_;
  if (quantity == kIncidenceCosine) return &incidence_cosine_;
  if (quantity == kSurfaceStd || quantity == kMeasurementStd) return &surface_std_;
  if (quantity == kUncertainty) return &uncertainty_;
  if (quantity == kStdReduction) return &std_reduction_;
  if (quantity == kExpectedDiscovery) return &expected_discovery_;
  return nullptr;
}

void LineValues::find_contacts(const SampledLines& lines, const Assembly& best) {
  const Eigen::Index count = lines.lines.size();
  distance_.resize(count);
  incidence_cosine_ = Eigen::VectorXd::Zero(count);
  places_.clear();
  meets_.clear();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Line one = line(lines, i);
    const double hit = best.first_intersection(one);
    distance_(i) = std::min({hit, lines.lines.line(i).length, distance_down_to(0.0, one)});
    if (hit > distance_(i)) continue;
    const Eigen::Vector3d at = one.origin + hit * one.direction;
    const Eigen::Vector3d normal = ResidualGp::normal(best, at);
    places_.push_back({at, normal});
    meets_.push_back(i);
    incidence_cosine_(i) = std::min(1.0, std::abs(normal.dot(one.direction)));
  }
}

void LineValues::compute_deviations(const ResidualGp& residual_gp) {
  const ResidualGp::Posterior posterior = residual_gp.posterior(places_);
  surface_std_ = Eigen::VectorXd::Zero(distance_.size());
  surface_std_(meets_) = posterior.variance.cwiseSqrt();
  clamped_ = posterior.clamped;
  // Scaled to a maximum of 1. Lines oblique to the surface reveal less of it and count as 0.
  constexpr double kAlong = 0.999;
  const double most = surface_std_.maxCoeff();
  const double scale = most > 0.0 ? 1.0 / most : 0.0;
  const Eigen::ArrayXd share = (scale * surface_std_.array()).square();
  uncertainty_ = (incidence_cosine_.array() > kAlong).select(share, 0.0);
}

void LineValues::compute_reductions(const Solids& solids, const ResidualGp& residual_gp) {
  constexpr std::size_t kMost = 300;
  constexpr double kSquarely = 0.5;
  const Representatives some = representatives(places_, kMost);
  factors_.redundant_taps = 0;  // only the latest count matters
  const Eigen::VectorXd reductions = expected_reductions(solids, residual_gp, some.places, &factors_);
  std_reduction_ = Eigen::VectorXd::Zero(distance_.size());
  for (std::size_t i = 0; i < meets_.size(); ++i) {
    if (incidence_cosine_(meets_[i]) > kSquarely)
      std_reduction_(meets_[i]) = reductions(static_cast<Eigen::Index>(some.stands_for[i]));
  }
}

void LineValues::compute_discovery(const SampledLines& lines, const Solids& solids, Random random) {
  constexpr int kDraws = 1000;
  constexpr double kMinEarlier = 0.003;  // metres: a primitive counts if it makes the contact earlier by more than this
  constexpr double kFarthest = 0.03;     // metres: larger differences count as this one
  const Eigen::Index count = distance_.size();
  expected_discovery_ = Eigen::VectorXd::Zero(count);
  const std::vector<Primitive> primitives = solids.undiscovered(solids.best(), kDraws, random);
  double anywhere = 0.0;
  Eigen::ArrayX3d origin(count, 3), direction(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Line one = line(lines, i);
    origin.row(i) = one.origin;
    direction.row(i) = one.direction;
    anywhere += lines.anywhere[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
  }
  std::vector<Eigen::Index> meets;
  Eigen::ArrayXd along(count), aside(count);
  for (const Primitive& primitive : primitives) {
    // Most lines miss the sphere around the primitive, or end before it.
    const double radius = primitive.half.norm();
    const auto apart = [&](Eigen::Index k) { return primitive.centre(k) - origin.col(k); };
    along = apart(0) * direction.col(0) + apart(1) * direction.col(1) + apart(2) * direction.col(2);
    aside = apart(0).square() + apart(1).square() + apart(2).square() - along.square();
    meets.clear();
    double moves = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (aside(i) > radius * radius || along(i) - radius > distance_(i)) continue;
      const double earlier =
          distance_(i) - primitive.first_intersection({origin.row(i).transpose(), direction.row(i).transpose()});
      if (earlier <= kMinEarlier) continue;
      meets.push_back(i);
      if (lines.anywhere[static_cast<std::size_t>(i)]) moves += std::min(kFarthest, earlier);
    }
    // Mean over the random lines.
    moves /= anywhere * kDraws;
    for (const Eigen::Index i : meets) expected_discovery_(i) += moves;
  }
}

}  // namespace palpate
