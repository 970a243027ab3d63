// SPDX-License-Identifier: MIT
// How good a reconstruction is, over the candidate cells, where the truth is known.
#pragma once

#include "experiment/tap_belief.hpp"

#include <palpate/scene.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// The scene as seen at the candidates.
struct Truth {
  Eigen::VectorXd height;                    ///< metres
  Eigen::Array<bool, Eigen::Dynamic, 1> on;  ///< the cell's centre is on an object
  Eigen::ArrayXi object = {};                ///< which, as Scene::object() numbers them; kNoObject where `on` is not
  int objects = 0;                           ///< of the scene
};

Truth truth_at(const Candidates& candidates, const Scene& scene);

/// Errors that need one of the two models; absent where there is no such cell or nobody asked for the model.
struct Errors {
  std::optional<double> rmse;           ///< metres, the reconstructed scene, desk included
  std::optional<double> rmse_object;    ///< metres, the same over the cells on an object
  std::optional<double> rmse_height;    ///< metres, the height mean itself over the cells on an object
  std::optional<double> footprint_iou;  ///< predicted against true cells on an object; 1 if both are empty
  // From any side alone; then there is no rmse, and rmse_object is over the points of the true surface.
  std::optional<double> surface_distance =
      std::nullopt;  ///< metres, mean distance from the points of either surface to the other
  std::optional<double> rms_surface_distance = std::nullopt;  ///< metres, root mean square of the same distances
  std::optional<double> f_score = std::nullopt;               ///< at 5 mm
  std::optional<double> coverage = std::nullopt;              ///< of the 95 % intervals of the surface from any side
  std::optional<double> volume_iou = std::nullopt;            ///< of what is solid; none if nothing is

  /// Returns the root mean square error of the whole reconstruction, metres, from above or from any side.
  std::optional<double> overall() const { return rmse ? rmse : rms_surface_distance; }
};

/// Throws Error (the run fails) where an error that is there is not a finite number; `taps` have been made.
void require_finite(const Errors& errors, int taps);

/// Root mean square of (map - truth.height), over all cells or over those on an object. None if there are none.
std::optional<double> rmse(const Eigen::VectorXd& map, const Truth& truth, bool only_on_object);

/// Intersection over union of the cells where `probability` >= 1/2 with those on an object.
double footprint_iou(const Eigen::VectorXd& probability, const Truth& truth);

/// What there is of a reconstruction.
struct SurfaceMaps {
  const Eigen::VectorXd* height = nullptr;       ///< mean, metres; null where nobody asked for it
  const Eigen::VectorXd* probability = nullptr;  ///< likewise
  bool two_part = false;
  double desk = 0.0;
};
SurfaceMaps maps_of(const TapBelief& belief, Quantities known);

/// The errors of what is there: without the probability a surface of two parts has none, without the height none has.
Errors errors_of(const SurfaceMaps& maps, const Truth& truth);

/// Does the height model know what it does not know? Over the cells on an object that were not tapped, noise included.
struct Calibration {
  /// Mean negative log predictive density, natural logarithm of 1/m; absent where a cell is certain to the last digit.
  std::optional<double> nlpd;
  std::optional<double> coverage_95;  ///< share of cells within the central 95 % interval
};
Calibration calibration(const TapBelief& belief, const Truth& truth, const std::vector<bool>& tapped);

/// The surface as the config's `surface` reconstructs it, metres: the height mean; for `two_part` only where the
/// footprint's probability is at least 1/2, else the desk. Both must have been asked for.
Eigen::VectorXd reconstruction(const TapBelief& belief);

}  // namespace palpate
