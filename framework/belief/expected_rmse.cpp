// SPDX-License-Identifier: MIT
#include "belief/expected_rmse.hpp"

#include <cmath>

namespace palpate {

double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance) {
  const auto p = probability.array();
  const auto wrong_outline = (p >= 0.5).select(1.0 - p, p);
  return (p * variance.array() + wrong_outline * mean.array().square()).mean();
}

double variance_ratio(const GaussianProcess& heights, double square) {
  const GpSettings& settings = heights.settings();
  const int level = settings.mean_ratio > 0.0 ? 1 : 0;  // removing the level costs one degree of freedom
  const GpDiagnostics diagnostics = heights.diagnostics();
  return (square / (settings.signal * settings.signal) + diagnostics.misfit) /
         (1 + heights.size() - diagnostics.factors.redundant_taps - level);
}

std::optional<double> expected_rmse(const SurfaceMaps& maps, const Eigen::VectorXd& variance,
                                    const GaussianProcess* heights, const std::vector<Touch>& object_contacts) {
  if (object_contacts.empty() || heights == nullptr) return std::nullopt;
  double squares = 0.0;
  for (const Touch& contact : object_contacts) squares += contact.height * contact.height;
  const Eigen::VectorXd scaled =
      variance * variance_ratio(*heights, squares / static_cast<int>(object_contacts.size()));
  const double square =
      maps.two_part ? expected_square(*maps.probability, maps.height->array() - maps.desk, scaled) : scaled.mean();
  return std::isfinite(square) ? std::optional(std::sqrt(square)) : std::nullopt;
}

}  // namespace palpate
