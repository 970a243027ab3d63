// SPDX-License-Identifier: MIT
#include "belief/height_model.hpp"

#include "gp/finite.hpp"

namespace palpate {

void HeightModel::update_maps(int taps) {
  gp_.update_maps();
  const GaussianProcess& process = gp_.process();
  process.read_relative_variance(uncertainty_);
  process.read_variance(0, variance_);
  require_finite(variance_, "the variance of the height GP", taps);  // the uncertainty is then finite, too
  if (has_mean_) read_surface(process, desk_, taps, mean_);
}

void LabelMap::update(const GaussianProcess& process, int output, int taps) {
  process.read_mean(output, mean_);
  require_finite(mean_, "the weight w", taps);
  clipped_ = mean_.cwiseMax(0.0).cwiseMin(1.0);
}

void read_surface(const GaussianProcess& process, double desk, int taps, Eigen::VectorXd& out) {
  process.read_mean(0, out);
  out.array() += desk;
  require_finite(out, "the height", taps);
}

}  // namespace palpate
