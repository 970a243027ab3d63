// SPDX-License-Identifier: MIT
// Gaussian process classification of the labels: a probability that stays in [0, 1] and falls back to the prior where
// nothing was touched.
#include "laplace.hpp"

#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <optional>

namespace palpate::footprints {

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
    const double evidence =
        posterior_ ? posterior_->log_evidence() : Laplace(*kernel_, settings_, points_, on_).log_evidence();
    return {{"log_evidence", evidence}};
  }

 private:
  std::shared_ptr<Kernel> kernel_;
  LaplaceSettings settings_;
  Points points_{0, 2};
  std::vector<bool> on_;
  std::optional<Laplace> posterior_;  ///< of all touches; none between one and the next question
};

PALPATE_PLUGIN(Footprint, Classifier, "classifier",
               "Gaussian process classification (Laplace's approximation, probit), for outlines of any form")

}  // namespace palpate::footprints
