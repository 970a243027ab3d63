// SPDX-License-Identifier: MIT
// Gaussian process classification with a probit likelihood by Laplace's approximation (Rasmussen and Williams 2006,
// sections 3.4 and 3.9). The model is a latent function f ~ GP(mean, signal^2 * k) with the probability Phi(f(x)) that
// x is on an object.
#pragma once

#include "regular/regular_factor.hpp"

#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate::footprints {

/// log Phi(z) and its derivatives: `slope` = phi(z) / Phi(z), and the second derivative -`weight` = -slope * (z +
/// slope). All are finite for all finite z; `weight` is in (0, 1).
struct Probit {
  double log = 0.0;
  double slope = 0.0;
  double weight = 0.0;  ///< negative second derivative
};
Probit probit(double z);

/// Returns Phi(z), the standard normal distribution function.
double normal_cdf(double z);

struct LaplaceOptions : Options {
  PluginChoice kernel{"kernel", {}, nullptr};
  double signal = 2.0;
  double prior_mean = -1.0;

  void list(Fields& fields) override {
    fields.plugin(kernel, Field("kernel", "covariance kernel of the classifier's latent function").needed());
    fields.real(signal,
                Field("signal", "prior standard deviation of the classifier's latent function").above(0).at_most(100));
    fields.real(prior_mean, Field("prior_mean",
                                  "prior mean of the classifier's latent function. For example, with -1 and a signal "
                                  "of 2, a third of the area is expected to be object"));
  }
};

/// Prior of the latent function f.
struct LaplaceSettings {
  double signal = 1.0;  ///< prior standard deviation of f, > 0
  double mean = 0.0;    ///< prior mean of f
};

/// Posterior of f given n labels. Damped Newton steps find the mode, which is unique because the log posterior is
/// concave. Contradictory labels at one position cause no numerical problems, because only I + W^1/2 * K * W^1/2 is
/// factorised.
class Laplace {
 public:
  /// `kernel` must outlive the object. `points` is n x 2, `on` has n entries.
  Laplace(const Kernel& kernel, const LaplaceSettings& settings, const PointsView& points, const std::vector<bool>& on);

  /// Sets `out` to the probability of an object at each position: Phi(mean / sqrt(1 + variance)), with the posterior
  /// mean and variance of f at the position.
  void probability(const PointsView& places, VectorOut out) const;

  /// Returns the approximate log p(labels), natural logarithm.
  double log_evidence() const { return log_evidence_; }
  /// Returns how the factorisation at the mode was corrected against rounding errors; its numbers have no unit. Only a
  /// kernel that is not positive definite needs corrections, because all eigenvalues of the factorised matrix are at
  /// least 1.
  const FactorReport& report() const { return factor_.report(); }

 private:
  void find_mode(const Eigen::MatrixXd& covariance);
  double objective(const Eigen::VectorXd& latent, const Eigen::VectorXd& dual) const;

  const Kernel& kernel_;
  LaplaceSettings settings_;
  Points points_;
  Eigen::VectorXd sign_;         ///< +1 on an object, -1 on the desk
  Eigen::VectorXd gradient_;     ///< gradient of the log likelihood at the mode
  Eigen::VectorXd root_weight_;  ///< W^1/2 at the mode
  RegularFactor factor_;         ///< factor of I + W^1/2 * K * W^1/2
  double log_evidence_ = 0.0;
};

/// The footprint `gp_classifier`, also used by `primitives`.
class Classifier final : public Footprint {
 public:
  using Options = LaplaceOptions;
  Classifier(const Options& options, const Context& context)
      : kernel_(context.create<Kernel>(options.kernel)), settings_{options.signal, options.prior_mean} {}

  void add(const Touch& touch) override {
    points_.conservativeResize(points_.rows() + 1, 2);
    points_.bottomRows<1>() << touch.place.x, touch.place.y;
    on_.push_back(touch.on);
    posterior_.reset();
  }

  void probability(const PointsView& places, VectorOut out) override {
    if (!posterior_) posterior_.emplace(*kernel_, settings_, points_, on_);
    posterior_->probability(places, out);
  }

  std::vector<FootprintNumber> numbers() const override {
    std::optional<Laplace> now;
    const Laplace& posterior = posterior_ ? *posterior_ : now.emplace(*kernel_, settings_, points_, on_);
    const FactorReport& factors = posterior.report();
    return {{"log_evidence", posterior.log_evidence()},
            {"jitter", factors.jitter},
            {"jitter_raised", static_cast<double>(factors.raised)},
            {"pivoted", static_cast<double>(factors.pivoted)},
            {"redundant_taps", static_cast<double>(factors.redundant_taps)}};
  }

 private:
  std::shared_ptr<Kernel> kernel_;
  LaplaceSettings settings_;
  Points points_{0, 2};
  std::vector<bool> on_;
  std::optional<Laplace> posterior_;  ///< posterior of all taps; reset by a new tap
};

}  // namespace palpate::footprints
