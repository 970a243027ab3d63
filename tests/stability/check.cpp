// SPDX-License-Identifier: MIT
#include "stability/check.hpp"

#include "stability/reference.hpp"
#include "support/gaussian_process.hpp"
#include "support/grids.hpp"
#include "support/mocks.hpp"
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::stability {
namespace {

using test::GaussianProcess;
using test::scattered;

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// `sound` becomes false if there ever was a number that is none.
GaussianProcess processed(const Problem& problem, const CandidateGrid& candidates, const EngineSettings& posterior,
                          bool& sound) {
  const Case& one = problem.one;
  // Before a fit the matrix is as singular as can be.
  const double length_scale = one.refit ? 1e4 * kSide : one.length_scale();
  const double signal = one.refit ? 3.0 * one.signal : one.signal;
  const double noise = one.refit ? 0.0 : one.noise();
  const auto kernel =
      test::make<Kernel>(test::shared_host(), one.kernel, fmt::format("{{length_scale: {} m}}", length_scale));
  GaussianProcess process(kernel, {signal, noise, one.mean, one.mean_ratio}, candidates, posterior);
  for (Eigen::Index i = 0; i < problem.values.size(); ++i) {
    process.add({problem.places(i, 0), problem.places(i, 1)}, problem.values(i));
    sound &=
        process.mean().allFinite() && process.variance().allFinite() && std::isfinite(process.engine().error_bound);
  }
  const test::ChangingFit bringing([&one](FitProblem& fit) {
    const double length = one.length_scale();
    fit.kernel.set_parameters(Eigen::Map<const Eigen::VectorXd>(&length, 1));
    fit.outputs.front().signal = one.signal;
    fit.noise_ratio = one.noise() / one.signal;
  });
  Random random(1, "stability");
  if (one.refit) process.fit(bringing, random);
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

std::string trouble_of(const GaussianProcess& process, const Answer& answer, const Case& one, bool sound) {
  const bool finite = sound && answer.mean.allFinite() && answer.variance.allFinite() && answer.tap_mean.allFinite() &&
                      std::isfinite(process.diagnostics().log_marginal_likelihood) &&
                      std::isfinite(process.diagnostics().condition);
  if (!finite) return "not a number";
  if (!(answer.jitter <= kJitterLimit * one.points * kEps)) return "jitter";
  if (process.diagnostics().factors.pivoted > 0 || process.diagnostics().factors.redundant_taps > 0)
    return "a tap was set aside";
  const bool within = answer.variance.minCoeff() >= 0.0L && answer.variance.maxCoeff() <= one.prior() * (1 + 4 * kEps);
  return within ? "" : "variance outside of [0; prior]";
}

struct Engine {
  const char* name;
  EngineSettings::Kind kind;
};
constexpr std::array<Engine, 4> kEngines{{{"dense", EngineSettings::Kind::dense},
                                          {"grid", EngineSettings::Kind::grid},
                                          {"lowrank", EngineSettings::Kind::lowrank},
                                          {"auto", EngineSettings::Kind::automatic}}};

/// The places that are asked about: the probes, and then taps.
Points asked(const Problem& problem, const Engine& engine) {
  // A product grid has the square of them as candidates: there, the taps are left out where they are many.
  constexpr Eigen::Index kFew = 40;
  const bool all = engine.kind == EngineSettings::Kind::dense || problem.places.rows() <= kFew;
  const Eigen::Index taps = all ? problem.places.rows() : 0;
  Points out(problem.probes.rows() + taps, 2);
  out << problem.probes, problem.places.topRows(taps);
  return out;
}

Answer answered(const Problem& problem, const Engine& engine) {
  const Case& one = problem.one;
  const Points places = asked(problem, engine);
  const bool dense = engine.kind == EngineSettings::Kind::dense;
  const CandidateGrid candidates = dense ? scattered(places) : test::product_grid(places.col(0), places.col(1));
  // Of a product grid, the places lie on the diagonal.
  const Eigen::Index step = dense ? 1 : places.rows() + 1;
  const auto at_places = [&](const Eigen::VectorXd& map) {
    return LongVector(Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>(map.data(), places.rows(),
                                                                                 Eigen::InnerStride<>(step))
                          .cast<long double>());
  };
  EngineSettings posterior;
  posterior.engine = engine.kind;
  posterior.taps = one.points;
  bool sound = true;
  const GaussianProcess process = processed(problem, candidates, posterior, sound);
  const LongVector mean = (at_places(process.mean()).array() - one.mean) / one.signal;
  const LongVector variance = at_places(process.variance()) / one.signal / one.signal;
  const Eigen::Index probes = problem.probes.rows();
  Answer out{mean.head(probes),
             variance.head(probes),
             mean.tail(places.rows() - probes),
             process.diagnostics().factors.jitter / one.signal / one.signal,
             {}};
  out.trouble = trouble_of(process, out, one, sound);
  return out;
}

double greatest(const LongVector& vector) { return static_cast<double>(vector.cwiseAbs().maxCoeff()); }

/// What of a row exceeds its bound.
std::string exceeds(const Row& row) {
  if (!(row.mean_error <= row.mean_bound)) return "mean";
  if (!(row.variance_error <= row.variance_bound)) return "variance";
  const double more = row.engine == "lowrank" ? EngineSettings{}.tolerance : 0.0;
  if (!(row.residual <= kResidualLimit * row.n_eps() + more)) return "residual";
  return {};
}

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
  if (row.engine == "lowrank") {
    const double more = EngineSettings{}.tolerance * row.condition;
    row.mean_bound += std::min(more, kMeanCap);
    row.variance_bound += std::min(more, kVarianceCap);
  }
  if (answer.tap_mean.size() > 0) {
    const double size = norm * truth.alpha + static_cast<double>(targets.norm());
    const double miss = static_cast<double>((truth.tap_mean - answer.tap_mean).norm());
    row.residual = miss == 0.0 ? 0.0 : miss / size;
  }
  if (row.trouble.empty()) row.trouble = exceeds(row);
}

}  // namespace

double Row::n_eps() const { return points * kEps; }

std::vector<Row> check(const Case& one) {
  const Problem problem(one);
  const Spectrum spectrum = stability::spectrum(problem);
  const bool separable = test::make<Kernel>(test::shared_host(), one.kernel)->separable();
  std::optional<Oracle> oracle;
  if (one.points <= kOraclePoints) oracle.emplace(one, problem.places, problem.values);
  std::optional<double> jitter;
  std::optional<Reference> truth;
  std::optional<Reference> exact;
  std::vector<Row> rows;
  for (const Engine& engine : kEngines) {
    if (engine.kind != EngineSettings::Kind::dense && !separable) continue;
    const Answer answer = answered(problem, engine);
    // All engines meet the same matrix, and thus most often raise the same jitter.
    if (!jitter || *jitter != answer.jitter) {
      jitter = answer.jitter;
      truth = oracle ? by_oracle(problem, *oracle, *jitter) : refined(problem, *jitter);
      exact = *jitter == 0.0 ? truth : (oracle ? by_oracle(problem, *oracle, 0.0) : std::nullopt);
    }
    Row row;
    row.name = one.name;
    row.engine = engine.name;
    row.points = one.points;
    row.condition = spectrum.condition();
    row.jitter = answer.jitter;
    row.trouble = answer.trouble;
    if (truth) compare(problem, spectrum, answer, *truth, exact, row);
    if (!truth && row.trouble.empty()) row.trouble = "a singular matrix went without jitter";
    rows.push_back(row);
  }
  return rows;
}

std::string header() {
  return "case,engine,points,condition,jitter,jitter_effect,mean_error,mean_bound,variance_error,variance_bound,"
         "residual,"
         "verdict";
}

std::string text(const Row& row) {
  const std::string effect = std::isnan(row.jitter_effect) ? "" : fmt::format("{:.2g}", row.jitter_effect);
  return fmt::format("{},{},{},{:.2g},{:.2g},{},{:.2g},{:.2g},{:.2g},{:.2g},{:.2g},{}", row.name, row.engine,
                     row.points, row.condition, row.jitter, effect, row.mean_error, row.mean_bound, row.variance_error,
                     row.variance_bound, row.residual, row.trouble.empty() ? "holds" : "fails: " + row.trouble);
}

}  // namespace palpate::stability
