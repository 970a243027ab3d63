// SPDX-License-Identifier: MIT
#include "experiment/forecast.hpp"

#include <cmath>

namespace palpate {

bool good_enough(const Forecast& forecast, double bound, double unsearched) {
  return forecast.rmse && kCaution * *forecast.rmse <= bound && forecast.unsearched <= unsearched;
}

double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance) {
  const auto p = probability.array();
  const auto wrong_outline = (p >= 0.5).select(1.0 - p, p);
  return (p * variance.array() + wrong_outline * mean.array().square()).mean();
}

double variance_ratio(const Process& heights, double square) {
  const ProcessSettings& settings = heights.settings();
  const int level = settings.mean_ratio > 0.0 ? 1 : 0;  // taken out of the heights, it costs one of them
  return (square / (settings.signal * settings.signal) + heights.misfit()) / (1 + heights.size() - level);
}

Forecaster::Forecaster(const Candidates& candidates)
    : candidates_(candidates), searched_(Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(candidates.size(), false)) {}

void Forecaster::observe(const Target& place, std::optional<double> hit) {
  const auto x = candidates_.points.col(0).array() - place.x;
  const auto y = candidates_.points.col(1).array() - place.y;
  searched_ = searched_ || (x.square() + y.square() <= kSearched * kSearched);
  if (!hit) return;
  squares_ += *hit * *hit;
  ++hits_;
}

Forecast Forecaster::forecast(const TapBelief& belief) const {
  Forecast out;
  out.unsearched = 1.0 - static_cast<double>(searched_.count()) / static_cast<double>(searched_.size());
  if (hits_ == 0) return out;
  Eigen::VectorXd variance = belief.height_variance();
  variance *= variance_ratio(*belief.surface_process().process, squares_ / hits_);
  const double square =
      belief.two_part() ? expected_square(belief.probability(), belief.height_mean().array() - belief.desk(), variance)
                        : variance.mean();
  if (std::isfinite(square)) out.rmse = std::sqrt(square);
  return out;
}

}  // namespace palpate
