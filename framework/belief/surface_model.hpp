// SPDX-License-Identifier: MIT
// The model of object heights for `surface: two_part`: a GP of the heights on objects, without outliers. Where the
// footprint has no object, the reconstructed surface is the desk, whatever this model computes.
#pragma once

#include "belief/gp_model.hpp"
#include "belief/outlier_model.hpp"

#include <palpate/backend.hpp>

#include <Eigen/Core>

#include <optional>

namespace palpate {

class SurfaceModel {
 public:
  /// `outlier_probability`: prior probability that a contact is an outlier; nullopt for no outlier model. `desk`:
  /// height of the desk, metres.
  SurfaceModel(GpModel gp, const std::optional<double>& outlier_probability, const CandidateGrid& candidates,
               double desk);

  GpModel& gp() { return gp_; }
  const GpModel& gp() const { return gp_; }

  /// Builds the GP. If `maps` is true, the next and all later calls of update_maps() compute maps. Returns whether the
  /// GP or the maps did not exist before.
  bool show(bool maps);
  /// Removes all data, because labels have changed.
  void reset();

  /// Returns whether the config has an outlier model. outliers() returns this model; null if there is none, and before
  /// show().
  bool has_outliers() const { return outliers_.has_value(); }
  const OutlierModel* outliers() const { return outliers_ && gp_.is_built() ? &*outliers_ : nullptr; }
  /// Computes the outliers again from the data of the GP. outliers() must not be null. `footprint` computes the
  /// probabilities of wrong labels; may be null.
  void find_outliers(const ContactLog& log, const Footprint* footprint);

  /// Updates the maps. Throws Error for values that are not finite.
  void update_maps(const ContactLog& log);
  /// Return mean (metres, in the frame of the scene) and variance (square metres), M values each. Both are empty before
  /// the first update_maps().
  const Eigen::VectorXd& mean() const { return mean_; }
  const Eigen::VectorXd& variance() const { return variance_; }
  /// Returns mean and standard deviation at a candidate without a map, bitwise equal to those of the maps. Requires
  /// show().
  Prediction predict(int candidate, const ContactLog& log) const;
  /// Returns the number of variances of the map that rounding made negative.
  int variances_clamped() const { return is_without_outliers() ? outliers_->surface().variances_clamped() : 0; }

 private:
  /// Returns whether the outlier model provides the surface; otherwise the GP does.
  bool is_without_outliers() const { return outliers() != nullptr && outliers_->is_surface(gp_); }

  GpModel gp_;
  std::optional<OutlierModel> outliers_;
  double desk_;
  bool has_maps_ = false;
  Eigen::VectorXd mean_, variance_;
};

}  // namespace palpate
