// SPDX-License-Identifier: MIT
// Which contacts are outliers: their label may be wrong, which the footprint finds, or the height of a contact on an
// object.
#pragma once

#include "belief/contact_log.hpp"
#include "belief/gp_model.hpp"
#include "gp/robust_surface.hpp"

#include <palpate/footprint.hpp>

#include <Eigen/Core>

namespace palpate {

class OutlierModel {
 public:
  /// From this probability on, the place of a contact may be tapped again.
  static constexpr double kRetapThreshold = 0.1;

  /// `prior`: probability that a contact is an outlier, in (0, 1). `candidates` must outlive it.
  OutlierModel(double prior, const CandidateGrid& candidates) : prior_(prior), surface_(candidates) {}

  /// Computes the probabilities again; returns false if they were kept, as so many contacts are known. `objects`: the
  /// GP of the heights on objects, built and with all data. `footprint`: knows the probabilities of wrong labels; null:
  /// all labels are right.
  bool update(const ContactLog& log, const GpModel& objects, const Footprint* footprint);
  /// Forgets the surface, as labels have changed.
  void reset() { surface_.reset(); }

  /// Of each contact at the latest update(); empty before.
  const Eigen::VectorXd& probabilities() const { return probabilities_; }
  /// The same by its label alone, without its height.
  const Eigen::VectorXd& by_label() const { return by_label_; }

  /// The surface without outliers. It has no map while is_surface() is false: then the surface is that of the GP.
  RobustSurface& surface() { return surface_; }
  const RobustSurface& surface() const { return surface_; }
  bool is_surface(const GpModel& objects) const {
    return surface_.excludes_outliers() && surface_.taps() == objects.process().size();
  }

 private:
  double prior_;
  RobustSurface surface_;
  Eigen::VectorXd probabilities_, by_label_;  ///< of each contact
};

}  // namespace palpate
