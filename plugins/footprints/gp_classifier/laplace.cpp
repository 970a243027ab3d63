// SPDX-License-Identifier: MIT
#include "laplace.hpp"

#include <palpate/math.hpp>

#include <cmath>

namespace palpate::footprints {
namespace {

constexpr double kRootHalf = 0.70710678118654752440;
constexpr double kLogRootTwoPi = 0.91893853320467274178;

/// Returns -z * Phi(z) / phi(z) - 1 for z <= -10. The value is the asymptotic series of Mills' ratio without its first
/// term. For these z, the terms decrease below 1e-9 of the first term before they grow.
double rest_of_mills(double z) {
  const double inverse = 1.0 / (z * z);
  double term = 1.0;
  double sum = 0.0;
  for (int k = 1; k <= 8; ++k) {
    term *= -(2 * k - 1) * inverse;
    sum += term;
  }
  return sum;
}

}  // namespace

double normal_cdf(double z) { return 0.5 * math::erfc(-z * kRootHalf); }

Probit probit(double z) {
  constexpr double kFar = -10.0;
  Probit out;
  const double log_density = -0.5 * z * z - kLogRootTwoPi;
  if (z > kFar) {
    out.log = math::log(normal_cdf(z));
    out.slope = math::exp(log_density - out.log);
    out.weight = out.slope * (z + out.slope);
  } else {
    const double rest = rest_of_mills(z);
    const double ratio = -(1.0 + rest) / z;
    out.log = log_density + math::log(ratio);
    out.slope = 1.0 / ratio;
    // Computed without the cancellation of slope + z: 1 / ratio + z = (1 + z * ratio) / ratio.
    out.weight = -out.slope * rest / ratio;
  }
  return out;
}

Laplace::Laplace(const Kernel& kernel, const LaplaceSettings& settings, const PointsView& points,
                 const std::vector<bool>& on)
    : kernel_(kernel), settings_(settings), points_(points), sign_(points.rows()) {
  for (Eigen::Index i = 0; i < sign_.size(); ++i) sign_(i) = on[static_cast<std::size_t>(i)] ? 1.0 : -1.0;
  Eigen::MatrixXd covariance(points_.rows(), points_.rows());
  kernel_.covariance(points_, points_, covariance);
  covariance *= settings_.signal * settings_.signal;
  find_mode(covariance);
}

/// Returns Psi of algorithm 3.1 (Rasmussen and Williams 2006): the log likelihood minus (f - mean)^T * K^-1 * (f -
/// mean) / 2. `dual` is K^-1 * (f - mean).
double Laplace::objective(const Eigen::VectorXd& latent, const Eigen::VectorXd& dual) const {
  double sum = -0.5 * dual.dot((latent.array() - settings_.mean).matrix());
  for (Eigen::Index i = 0; i < latent.size(); ++i) sum += probit(sign_(i) * latent(i)).log;
  return sum;
}

void Laplace::find_mode(const Eigen::MatrixXd& covariance) {
  constexpr int kMostSteps = 60;
  constexpr double kEnough = 1e-10;
  const Eigen::Index n = sign_.size();
  Eigen::VectorXd dual = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd latent = Eigen::VectorXd::Constant(n, settings_.mean);
  Eigen::VectorXd weight(n);
  Eigen::MatrixXd inner_matrix;
  gradient_.resize(n);
  double best = objective(latent, dual);
  for (int steps = 0;; ++steps) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Probit at = probit(sign_(i) * latent(i));
      gradient_(i) = sign_(i) * at.slope;
      weight(i) = at.weight;
    }
    root_weight_ = weight.cwiseSqrt();
    inner_matrix = root_weight_.asDiagonal() * covariance * root_weight_.asDiagonal();
    inner_matrix.diagonal().array() += 1.0;
    factor_.factorise(inner_matrix);
    if (steps == kMostSteps) break;
    // Newton step: K^-1 * (f_new - mean) = b - W^1/2 * B^-1 * W^1/2 * K * b, with b = W * (f - mean) + gradient and B =
    // I + W^1/2 * K * W^1/2.
    const Eigen::VectorXd b = weight.cwiseProduct((latent.array() - settings_.mean).matrix()) + gradient_;
    Eigen::VectorXd inner = root_weight_.cwiseProduct(covariance * b);
    factor_.solve(inner);
    const Eigen::VectorXd direction = b - root_weight_.cwiseProduct(inner) - dual;
    const Eigen::VectorXd change = covariance * direction;
    double step = 1.0;
    double reached = objective(latent + change, dual + direction);
    for (int halvings = 0; !(reached >= best) && halvings < 40; ++halvings) {
      step /= 2;
      reached = objective(latent + step * change, dual + step * direction);
    }
    if (!(reached > best + kEnough * (1.0 + std::abs(best)))) break;
    best = reached;
    latent += step * change;
    dual += step * direction;
  }
  log_evidence_ = best - factor_.half_log_determinant();
}

void Laplace::probability(const PointsView& places, VectorOut out) const {
  const double variance = settings_.signal * settings_.signal;
  Eigen::VectorXd prior(places.rows());
  kernel_.variance(places, prior);
  Eigen::MatrixXd cross(points_.rows(), places.rows());
  kernel_.covariance(points_, places, cross);
  const Eigen::VectorXd mean = variance * (cross.transpose() * gradient_);
  cross = (variance * root_weight_).asDiagonal() * cross;
  factor_.solve_lower(cross);
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const double spread = std::max(variance * prior(i) - cross.col(i).squaredNorm(), 0.0);
    out(i) = normal_cdf((settings_.mean + mean(i)) / std::sqrt(1.0 + spread));
  }
}

}  // namespace palpate::footprints
