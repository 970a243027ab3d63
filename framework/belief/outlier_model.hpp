// SPDX-License-Identifier: MIT
// Probabilities that contacts are outliers. A contact is an outlier if its label is wrong, or if it is on an object and
// its height is wrong. The footprint infers which labels are wrong.
#pragma once

#include "belief/contact_log.hpp"
#include "belief/gp_model.hpp"
#include "gp/robust_surface.hpp"

#include <palpate/footprint.hpp>

#include <Eigen/Core>

namespace palpate {

class OutlierModel {
 public:
  /// Least outlier probability at which the position of a contact may be tapped again.
  static constexpr double kRetapThreshold = 0.1;

  /// `prior`: probability that a contact is an outlier, in (0, 1). `candidates` must outlive the model.
  OutlierModel(double prior, const CandidateGrid& candidates) : prior_(prior), surface_(candidates) {}

  /// Computes the probabilities again. With more than 100 object contacts, returns false: earlier contacts keep their
  /// probabilities, and new contacts get the probability 0. `objects`: the built GP of the heights on objects, with all
  /// data. `footprint` computes the probabilities of wrong labels; if it is null, all labels count as right.
  bool update(const ContactLog& log, const GpModel& objects, const Footprint* footprint);
  /// Removes the surface, because labels have changed.
  void reset() { surface_.reset(); }

  /// Returns the outlier probability of each contact at the latest update(); empty before the first update().
  const Eigen::VectorXd& probabilities() const { return probabilities_; }
  /// Returns for each contact the probability that its label is wrong, computed without the heights.
  const Eigen::VectorXd& by_label() const { return by_label_; }

  /// Returns the surface that excludes outliers. While is_surface() is false, this surface has no map, and the
  /// posterior of the GP replaces it.
  RobustSurface& surface() { return surface_; }
  const RobustSurface& surface() const { return surface_; }
  bool is_surface(const GpModel& objects) const {
    return surface_.excludes_outliers() && surface_.taps() == objects.process().size();
  }

 private:
  double prior_;
  RobustSurface surface_;
  Eigen::VectorXd probabilities_, by_label_;  ///< one value per contact
};

}  // namespace palpate
