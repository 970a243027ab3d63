// SPDX-License-Identifier: MIT
#include "experiment/forecast.hpp"

#include "config/relation.hpp"

#include <cmath>

namespace palpate {

bool good_enough(const Forecast& forecast, double bound) {
  const double caution = forecast.left ? kCaution : kMoreCaution;
  return forecast.rmse && satisfies(caution * *forecast.rmse, Relation::at_most, bound) &&
         (!forecast.left || satisfies(forecast.left, Relation::at_most, kMostLeft));
}

double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance) {
  const auto p = probability.array();
  const auto wrong_outline = (p >= 0.5).select(1.0 - p, p);
  return (p * variance.array() + wrong_outline * mean.array().square()).mean();
}

double variance_ratio(const GaussianProcess& heights, double square) {
  const GpSettings& settings = heights.settings();
  const int level = settings.mean_ratio > 0.0 ? 1 : 0;  // taken out of the heights, it costs one of them
  const GpDiagnostics diagnostics = heights.diagnostics();
  return (square / (settings.signal * settings.signal) + diagnostics.misfit) /
         (1 + heights.size() - diagnostics.factors.redundant_taps - level);
}

void Forecaster::hit(double height) {
  squares_ += height * height;
  ++hits_;
}

Forecast Forecaster::forecast(const TapBelief& belief) const {
  Forecast out;
  if (hits_ == 0) return out;
  Eigen::VectorXd variance = belief.height_variance();
  variance *= variance_ratio(*belief.surface_gp().process, squares_ / hits_);
  const double square =
      belief.two_part() ? expected_square(belief.probability(), belief.height_mean().array() - belief.desk(), variance)
                        : variance.mean();
  if (std::isfinite(square)) out.rmse = std::sqrt(square);
  if (belief.footprint() != nullptr) out.left = belief.footprint()->undiscovered_probability();
  return out;
}

}  // namespace palpate
