// SPDX-License-Identifier: MIT
#include "stability/reference.hpp"

#include "support/eigenvalues.hpp"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace palpate::stability {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

long double kernel(const Case& one, long double dx, long double dy) {
  const long double r2 = (dx * dx + dy * dy) / one.length_scale() / one.length_scale();
  if (one.kernel == "rbf") return std::exp(-r2 / 2);
  const long double s = std::sqrt(5 * r2);
  return (1 + s + s * s / 3) * std::exp(-s);
}

LongMatrix covariance(const Case& one, const Points& a, const Points& b) {
  LongMatrix out(a.rows(), b.rows());
  for (Eigen::Index j = 0; j < b.rows(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      out(i, j) = kernel(one, static_cast<long double>(a(i, 0)) - b(j, 0), static_cast<long double>(a(i, 1)) - b(j, 1));
    }
  }
  return out;
}

LongMatrix covariance_of_taps(const Problem& problem) {
  LongMatrix out = covariance(problem.one, problem.places, problem.places);
  const long double noise = static_cast<long double>(problem.one.noise()) / problem.one.signal;
  out.diagonal().array() += noise * noise;
  return out;
}

using Lu = Eigen::PartialPivLU<Eigen::MatrixXd>;

/// x with matrix x = b, to about the last digit of b in double.
LongMatrix solve_refined(const LongMatrix& matrix, const Lu& lu, const LongMatrix& b) {
  constexpr int kSteps = 6;
  LongMatrix x = LongMatrix::Zero(b.rows(), b.cols());
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::MatrixXd residual = (b - matrix * x).cast<double>();
    x += lu.solve(residual).cast<long double>();
  }
  return x;
}

/// The eigenvalue of largest size of what `apply` does, a little too small at most.
template <class Apply>
double dominant(Eigen::Index n, Apply apply) {
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, 1.0, 2.0).normalized();
  double value = 0.0;
  for (int i = 0; i < 30; ++i) {
    x = apply(x).eval();
    value = x.norm();
    x /= value;
  }
  return value;
}

}  // namespace

Problem::Problem(const Case& which)
    : one(which),
      places(stability::places(which)),
      values(stability::values(which, places)),
      probes(stability::probes(which, places)) {}

double Spectrum::condition() const {
  return smallest > 1e-14 * largest ? largest / smallest : std::numeric_limits<double>::infinity();
}

Spectrum spectrum(const Problem& problem) {
  const Eigen::MatrixXd matrix = covariance_of_taps(problem).cast<double>();
  if (matrix.rows() <= kOraclePoints) {
    const Eigen::VectorXd values = test::eigenvalues(matrix);
    return {values(matrix.rows() - 1), values(0)};
  }
  const Lu lu(matrix);
  const double largest = dominant(matrix.rows(), [&](const Eigen::VectorXd& x) { return matrix * x; });
  const double inverse = dominant(matrix.rows(), [&](const Eigen::VectorXd& x) { return lu.solve(x); });
  return {largest, std::isfinite(inverse) ? 1.0 / inverse : 0.0};
}

std::optional<Reference> by_oracle(const Problem& problem, Oracle& oracle, double jitter) {
  if (!oracle.factorise(jitter)) return std::nullopt;
  Reference out;
  out.mean.resize(problem.probes.rows());
  out.variance.resize(problem.probes.rows());
  for (Eigen::Index i = 0; i < problem.probes.rows(); ++i) {
    const Oracle::Posterior posterior = oracle.at(problem.probes(i, 0), problem.probes(i, 1));
    out.mean(i) = static_cast<long double>(posterior.mean);
    out.variance(i) = static_cast<long double>(posterior.variance);
    out.weights = std::max(out.weights, posterior.weights);
  }
  out.tap_mean.resize(problem.places.rows());
  for (Eigen::Index i = 0; i < problem.places.rows(); ++i) {
    // The covariance without its diagonal addition, times alpha.
    const auto tap = static_cast<std::size_t>(i);
    out.tap_mean(i) = static_cast<long double>(Real(oracle.targets()[tap] - oracle.diagonal() * oracle.alpha()[tap]));
    out.alpha = std::hypot(out.alpha, static_cast<double>(oracle.alpha()[tap]));
  }
  out.least = oracle.least_pivot();
  return out;
}

Reference refined(const Problem& problem, double jitter) {
  LongMatrix matrix = covariance_of_taps(problem);
  matrix.diagonal().array() += static_cast<long double>(jitter);
  const Lu lu(matrix.cast<double>());
  const Eigen::Index n = matrix.rows();
  LongMatrix right(n, problem.probes.rows() + 1);
  const LongMatrix cross = covariance(problem.one, problem.places, problem.probes);
  right.leftCols(cross.cols()) = cross;
  right.rightCols(1) = (problem.values.cast<long double>().array() - problem.one.mean) / problem.one.signal;
  const LongMatrix solved = solve_refined(matrix, lu, right);
  const LongVector alpha = solved.rightCols(1);

  Reference out;
  out.mean = cross.transpose() * alpha;
  out.variance = 1.0L - cross.cwiseProduct(solved.leftCols(cross.cols())).colwise().sum().transpose().array();
  const long double noise = static_cast<long double>(problem.one.noise()) / problem.one.signal;
  out.tap_mean = right.rightCols(1) - (noise * noise + jitter) * alpha;
  out.alpha = static_cast<double>(alpha.norm());
  out.weights = static_cast<double>(solved.leftCols(cross.cols()).colwise().norm().maxCoeff());
  out.least = 1.0 / dominant(n, [&](const Eigen::VectorXd& x) { return lu.solve(x); });
  return out;
}

}  // namespace palpate::stability
