// SPDX-License-Identifier: MIT
// How good a reconstruction is, over the candidate cells, where the truth is known.
#pragma once

#include "gp/candidate_grid.hpp"

#include <palpate/errors.hpp>
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

Truth truth_at(const CandidateGrid& candidates, const Scene& scene);

/// Root mean square of (map - truth.height), over all cells or over those on an object. None if there are none.
std::optional<double> rmse(const Eigen::VectorXd& map, const Truth& truth, bool only_on_object);

/// Intersection over union of the cells where `probability` >= 1/2 with those on an object.
double footprint_iou(const Eigen::VectorXd& probability, const Truth& truth);

/// The arrays that a reconstruction is made of; null without their model.
struct SurfaceMaps {
  const Eigen::VectorXd* height = nullptr;  ///< mean, metres
  const Eigen::VectorXd* probability = nullptr;
  bool two_part = false;
  double desk = 0.0;
};

/// Returns the reconstructed surface, metres: the mean height; with `two_part` only where the probability is at least
/// 1/2, else the desk.
Eigen::VectorXd reconstruction(const SurfaceMaps& maps);

/// Returns the errors of the arrays that are there. A surface of two parts has none without the probability.
Errors errors_of(const SurfaceMaps& maps, const Truth& truth);

/// Does the height model know what it does not know? Over the cells on an object that were not tapped, noise included.
struct Calibration {
  /// Mean negative log predictive density, natural logarithm of 1/m; absent where a cell is certain to the last digit.
  std::optional<double> nlpd;
  std::optional<double> coverage_95;  ///< share of cells within the central 95 % interval
};
/// `variance`: of the heights, square metres; `noise`: standard deviation of a tap, metres; `tapped`: whether a
/// candidate was tapped.
Calibration calibration(const Eigen::VectorXd& mean, const Eigen::VectorXd& variance, double noise, const Truth& truth,
                        const std::vector<bool>& tapped);

}  // namespace palpate
