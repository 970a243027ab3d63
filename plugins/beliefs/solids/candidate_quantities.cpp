// SPDX-License-Identifier: MIT
#include "solids/candidate_quantities.hpp"

#include "solids/expected_reduction.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

Line CandidateQuantities::line(const SampledLines& lines, Eigen::Index index) const {
  const TapLine one = lines.lines.line(index);
  return {one.start - Eigen::Vector3d(0.0, 0.0, desk_), one.direction};
}

void CandidateQuantities::compute(const SampledLines& lines, const AssemblySampler& solids,
                                  const ResidualGp& residual_gp, const QuantitySet& reads, Random random) {
  using namespace quantity;
  reads_ = reads;
  const auto has = [&](const char* name) { return reads.count(name) != 0; };
  find_contacts(lines, solids.best());
  arrays_.clear();
  if (has(kExpectedDistance)) arrays_[kExpectedDistance] = distance_;
  if (has(kIncidenceCosine)) arrays_[kIncidenceCosine] = incidence_cosine_;
  if (has(kSurfaceStd) || has(kMeasurementStd) || has(kUncertainty)) {
    const Eigen::VectorXd surface_std = deviations(residual_gp);
    if (has(kSurfaceStd)) arrays_[kSurfaceStd] = surface_std;
    if (has(kMeasurementStd)) arrays_[kMeasurementStd] = surface_std;
    if (has(kUncertainty)) arrays_[kUncertainty] = uncertainty(surface_std);
  }
  if (has(kStdReduction)) arrays_[kStdReduction] = reductions(solids, residual_gp);
  if (has(kExpectedDiscovery)) arrays_[kExpectedDiscovery] = discovery(lines, solids, random);
}

void CandidateQuantities::find_contacts(const SampledLines& lines, const Assembly& best) {
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
    const Eigen::Vector3d normal = best.normal(at);
    places_.push_back({at, normal});
    meets_.push_back(i);
    incidence_cosine_(i) = std::min(1.0, std::abs(normal.dot(one.direction)));
  }
}

Eigen::VectorXd CandidateQuantities::deviations(const ResidualGp& residual_gp) {
  const ResidualGp::Posterior posterior = residual_gp.posterior(places_);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(distance_.size());
  out(meets_) = posterior.variance.cwiseSqrt();
  clamped_ = posterior.clamped;
  return out;
}

Eigen::VectorXd CandidateQuantities::uncertainty(const Eigen::VectorXd& deviations) const {
  // The largest value is 1, whatever the unit of the deviations. Lines at an angle to the normal reveal less of the
  // surface, so their value is 0.
  constexpr double kAlong = 0.999;
  const double most = deviations.maxCoeff();
  const double scale = most > 0.0 ? 1.0 / most : 0.0;
  const Eigen::ArrayXd share = (scale * deviations.array()).square();
  return (incidence_cosine_.array() > kAlong).select(share, 0.0);
}

Eigen::VectorXd CandidateQuantities::reductions(const AssemblySampler& solids, const ResidualGp& residual_gp) {
  constexpr std::size_t kMost = 300;
  constexpr double kSquarely = 0.5;
  const Representatives some = representatives(places_, kMost);
  factors_.redundant_taps = 0;  // the number refers to this call alone
  const Eigen::VectorXd expected = expected_reductions(solids, residual_gp, some.places, &factors_);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(distance_.size());
  for (std::size_t i = 0; i < meets_.size(); ++i) {
    if (incidence_cosine_(meets_[i]) > kSquarely)
      out(meets_[i]) = expected(static_cast<Eigen::Index>(some.stands_for[i]));
  }
  return out;
}

Eigen::VectorXd CandidateQuantities::discovery(const SampledLines& lines, const AssemblySampler& solids,
                                               Random random) const {
  constexpr int kDraws = 1000;
  constexpr double kMinEarlier = 0.003;  // metres: a primitive counts if it makes the contact earlier by more than this
  constexpr double kFarthest = 0.03;     // metres: larger differences are set to this value
  const Eigen::Index count = distance_.size();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(count);
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
    // Mean over the random lines, times the probability of this draw.
    moves /= anywhere * kDraws;
    for (const Eigen::Index i : meets) out(i) += moves;
  }
  return out;
}

}  // namespace palpate
