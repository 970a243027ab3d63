// SPDX-License-Identifier: MIT
#include "stability/check.hpp"

#include "gp/process.hpp"
#include "stability/reference.hpp"
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::stability {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Sets the hyperparameters of the case.
class Bringing final : public Fitting {
 public:
  explicit Bringing(const Case& one) : one_(one) {}
  bool due(int) const override { return true; }
  FitSummary fit(FitProblem& problem, Random&) const override {
    const double length_scale = one_.length_scale();
    problem.kernel.set_parameters(Eigen::Map<const Eigen::VectorXd>(&length_scale, 1));
    problem.outputs.front().signal = one_.signal;
    problem.noise_ratio = one_.noise() / one_.signal;
    FitSummary summary;
    summary.changed = true;
    return summary;
  }

 private:
  const Case& one_;
};

/// `sound` becomes false if there ever was a number that is none.
Process processed(const Problem& problem, const Points& candidates, bool& sound) {
  const Case& one = problem.one;
  // Before a fit the matrix is as singular as can be.
  const double length_scale = one.refit ? 1e4 * kSide : one.length_scale();
  const double signal = one.refit ? 3.0 * one.signal : one.signal;
  const double noise = one.refit ? 0.0 : one.noise();
  const auto kernel =
      test::make<Kernel>(test::shared_host(), one.kernel, fmt::format("{{length_scale: {} m}}", length_scale));
  Process process(kernel, {signal, noise, one.mean, one.mean_ratio}, candidates);
  for (Eigen::Index i = 0; i < problem.values.size(); ++i) {
    process.add({problem.places(i, 0), problem.places(i, 1)}, problem.values(i));
    sound &= process.mean().allFinite() && process.variance().allFinite();
  }
  Random random(1, "stability");
  if (one.refit) process.fit(Bringing(one), random);
  return process;
}

/// What the framework answers, standardised.
struct Answer {
  LongVector mean;      ///< at the probes
  LongVector variance;  ///< at the probes
  LongVector tap_mean;  ///< at the taps
  double jitter = 0.0;
  std::string trouble;
};

std::string trouble_of(const Process& process, const Answer& answer, const Case& one, bool sound) {
  const bool finite = sound && answer.mean.allFinite() && answer.variance.allFinite() && answer.tap_mean.allFinite() &&
                      std::isfinite(process.log_marginal_likelihood()) && std::isfinite(process.condition());
  if (!finite) return "not a number";
  if (!(answer.jitter <= kJitterLimit * one.points * kEps)) return "jitter";
  if (process.pivoted() > 0 || process.set_aside() > 0) return "a tap was set aside";
  const bool within = answer.variance.minCoeff() >= 0.0L && answer.variance.maxCoeff() <= one.prior() * (1 + 4 * kEps);
  return within ? "" : "variance outside of [0; prior]";
}

Answer answered(const Problem& problem) {
  const Case& one = problem.one;
  const Eigen::Index count = problem.probes.rows();
  Points candidates(count + problem.places.rows(), 2);
  candidates << problem.probes, problem.places;
  bool sound = true;
  const Process process = processed(problem, candidates, sound);
  const LongVector mean = (process.mean().cast<long double>().array() - one.mean) / one.signal;
  const LongVector variance = process.variance().cast<long double>() / one.signal / one.signal;
  Answer out{mean.head(count),
             variance.head(count),
             mean.tail(problem.places.rows()),
             process.jitter() / one.signal / one.signal,
             {}};
  out.trouble = trouble_of(process, out, one, sound);
  return out;
}

double greatest(const LongVector& vector) { return static_cast<double>(vector.cwiseAbs().maxCoeff()); }

/// Compares with the truth of the same model; `exact` is that of the model without jitter.
void compare(const Problem& problem, const Spectrum& spectrum, const Answer& answer, const Reference& truth,
             const std::optional<Reference>& exact, Row& row) {
  const Case& one = problem.one;
  const LongVector targets = (problem.values.cast<long double>().array() - one.mean) / one.signal;
  const double scale = std::max(std::sqrt(one.prior()) * std::max(1.0, greatest(targets)), greatest(truth.mean));
  row.mean_error = greatest(truth.mean - answer.mean) / scale;
  row.variance_error = greatest(truth.variance - answer.variance) / one.prior();
  row.jitter_effect = exact ? std::max(greatest(truth.mean - exact->mean) / scale,
                                       greatest(truth.variance - exact->variance) / one.prior())
                            : std::nan("");

  const double norm = spectrum.largest + answer.jitter;
  if (row.condition < kBeyond) {
    const double bound = row.n_eps() * row.condition;
    row.mean_bound = row.condition < 1e8 ? std::min(10.0 * bound, 1e-6) : bound;
    row.variance_bound = row.mean_bound;
  } else {
    const double bound = row.n_eps() * norm / truth.least;
    const double backward = row.n_eps() * norm * truth.weights;
    row.mean_bound = std::min({bound, backward * truth.alpha / scale, kMeanCap});
    row.variance_bound = std::min({bound, backward * truth.weights / one.prior(), kVarianceCap});
  }
  const double size = norm * truth.alpha + static_cast<double>(targets.norm());
  const double miss = static_cast<double>((truth.tap_mean - answer.tap_mean).norm());
  row.residual = miss == 0.0 ? 0.0 : miss / size;

  if (!row.trouble.empty()) return;
  if (!(row.mean_error <= row.mean_bound)) row.trouble = "mean";
  if (!(row.variance_error <= row.variance_bound)) row.trouble = "variance";
  if (!(row.residual <= kResidualLimit * row.n_eps())) row.trouble = "residual";
}

}  // namespace

double Row::n_eps() const { return points * kEps; }

Row check(const Case& one) {
  const Problem problem(one);
  const Spectrum spectrum = stability::spectrum(problem);
  const Answer answer = answered(problem);
  Row row;
  row.name = one.name;
  row.points = one.points;
  row.condition = spectrum.condition();
  row.jitter = answer.jitter;
  row.trouble = answer.trouble;
  std::optional<Reference> truth;
  std::optional<Reference> exact;
  if (one.points <= kOraclePoints) {
    OracleRoute route(problem);
    truth = route.solve(answer.jitter);
    exact = answer.jitter > 0.0 ? route.solve(0.0) : truth;
  } else {
    truth = refined(problem, answer.jitter);
    if (answer.jitter == 0.0) exact = truth;
  }
  if (truth) compare(problem, spectrum, answer, *truth, exact, row);
  if (!truth && row.trouble.empty()) row.trouble = "a singular matrix went without jitter";
  return row;
}

std::string header() {
  return "case,points,condition,jitter,jitter_effect,mean_error,mean_bound,variance_error,variance_bound,residual,"
         "verdict";
}

std::string text(const Row& row) {
  const std::string effect = std::isnan(row.jitter_effect) ? "" : fmt::format("{:.2g}", row.jitter_effect);
  return fmt::format("{},{},{:.2g},{:.2g},{},{:.2g},{:.2g},{:.2g},{:.2g},{:.2g},{}", row.name, row.points,
                     row.condition, row.jitter, effect, row.mean_error, row.mean_bound, row.variance_error,
                     row.variance_bound, row.residual, row.trouble.empty() ? "holds" : "fails: " + row.trouble);
}

}  // namespace palpate::stability
