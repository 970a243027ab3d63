// SPDX-License-Identifier: MIT
// Errors of a reconstruction over the candidate cells, compared with the true scene.
#pragma once

#include "gp/candidate_grid.hpp"

#include <palpate/reconstruction_errors.hpp>
#include <palpate/scene.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// The true scene at the candidates.
struct Truth {
  Eigen::VectorXd height;                    ///< metres
  Eigen::Array<bool, Eigen::Dynamic, 1> on;  ///< whether the cell's centre is on an object
  Eigen::ArrayXi object = {};                ///< index as in Scene::object(); kNoObject if not `on`
  int objects = 0;                           ///< number of objects in the scene
};

Truth truth_at(const CandidateGrid& candidates, const Scene& scene);

/// Returns the root mean square of (map - truth.height) over all cells or, with `only_on_object`, over the cells on an
/// object; nullopt if there are none.
std::optional<double> rmse(const Eigen::VectorXd& map, const Truth& truth, bool only_on_object);

/// Returns the intersection over union of the cells with `probability` >= 1/2 and the cells on an object.
double footprint_iou(const Eigen::VectorXd& probability, const Truth& truth);

/// The arrays of a reconstruction; null if their model is not built.
struct SurfaceMaps {
  const Eigen::VectorXd* height = nullptr;  ///< mean, metres
  const Eigen::VectorXd* probability = nullptr;
  bool two_part = false;
  double desk = 0.0;
};

/// Returns the reconstructed surface, metres: the mean height. With `two_part` this holds only where the probability is
/// at least 1/2; elsewhere the surface is the desk.
Eigen::VectorXd reconstruction(const SurfaceMaps& maps);

/// Returns the errors of the available arrays. With `two_part`, errors of the surface need the probability.
Errors errors_of(const SurfaceMaps& maps, const Truth& truth);

/// Calibration of the height model, noise included, over the untapped cells on an object.
struct Calibration {
  /// Mean negative natural logarithm of the predictive density in 1/m; absent if the variance of a cell is 0.
  std::optional<double> nlpd;
  std::optional<double> coverage_95;  ///< share of cells whose true height is within the central 95 % interval
};
/// Returns the calibration of heights. `variance`: variance of the heights, square metres; `noise`: standard deviation
/// of the noise of a tap, metres; `tapped`: whether each candidate has been tapped.
Calibration calibration(const Eigen::VectorXd& mean, const Eigen::VectorXd& variance, double noise, const Truth& truth,
                        const std::vector<bool>& tapped);

}  // namespace palpate
