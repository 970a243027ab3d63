// SPDX-License-Identifier: MIT
#include "belief/surface_model.hpp"

#include "belief/height_model.hpp"
#include "gp/finite.hpp"

#include <cmath>
#include <utility>

namespace palpate {

SurfaceModel::SurfaceModel(GpModel gp, const std::optional<double>& outlier_probability,
                           const CandidateGrid& candidates, double desk)
    : gp_(std::move(gp)), desk_(desk) {
  if (outlier_probability) outliers_.emplace(*outlier_probability, candidates);
}

bool SurfaceModel::show(bool maps) {
  const bool more = gp_.show(0) || (maps && !has_maps_);
  if (maps && !has_maps_) {
    has_maps_ = true;
    gp_.set_stale(true);
  }
  return more;
}

void SurfaceModel::reset() {
  gp_.reset();
  if (outliers_) outliers_->reset();
}

void SurfaceModel::find_outliers(const ContactLog& log, const Footprint* footprint) {
  if (outliers_->update(log, gp_, footprint)) gp_.set_stale(true);
}

void SurfaceModel::update_maps(const ContactLog& log) {
  if (!gp_.is_built()) return;
  // If the outlier model provides the surface, it has its own maps, and the maps of the GP are needed only for the
  // record.
  if (has_maps_ || !is_without_outliers()) gp_.update_maps();
  if (!gp_.is_stale() || !has_maps_) return;
  if (is_without_outliers()) {
    outliers_->surface().read_mean(gp_.process(), mean_);
    mean_.array() += desk_;
    outliers_->surface().read_variance(gp_.process(), variance_);
  } else {
    read_surface(gp_.process(), desk_, log.taps(), mean_);
    gp_.process().read_variance(0, variance_);
  }
  variance_.array() += log.reader().offset_variance();
  require_finite(mean_, "the height", log.taps());
  require_finite(variance_, "the variance of the height", log.taps());
  gp_.set_stale(false);
}

Prediction SurfaceModel::predict(int candidate, const ContactLog& log) const {
  RobustSurface::Height height;
  if (is_without_outliers()) {
    height = outliers_->surface().at(gp_.process(), candidate);
  } else {
    Eigen::VectorXd map;
    gp_.process().read_mean(0, map);
    height.mean = map(candidate);
    gp_.process().read_variance(0, map);
    height.variance = map(candidate);
  }
  return {height.mean + desk_, std::sqrt(height.variance + log.reader().offset_variance()), {}};
}

}  // namespace palpate
