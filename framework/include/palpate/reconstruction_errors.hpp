// SPDX-License-Identifier: MIT
// Errors of a reconstruction against the true scene. runs/README.md has the formulas.
#pragma once

#include <optional>

namespace palpate {

/// An error is absent if it has no cells or points, or if its models are not built.
struct Errors {
  std::optional<double> rmse = std::nullopt;           ///< metres, of the reconstructed heights, desk included
  std::optional<double> rmse_object = std::nullopt;    ///< metres, of the reconstructed heights over the true objects
  std::optional<double> rmse_height = std::nullopt;    ///< metres, of the mean height over the true objects
  std::optional<double> footprint_iou = std::nullopt;  ///< 1 if both footprints are empty
  // Errors of closed surfaces.
  std::optional<double> surface_distance = std::nullopt;      ///< metres, mean symmetric distance
  std::optional<double> rms_surface_distance = std::nullopt;  ///< metres, root mean square of the symmetric distances
  std::optional<double> f_score = std::nullopt;               ///< F-score at 5 mm
  std::optional<double> coverage = std::nullopt;              ///< coverage of the 95 % intervals of the surface
  std::optional<double> volume_iou = std::nullopt;            ///< absent if nothing is solid

  /// Returns the root mean square error of the whole reconstruction, metres.
  std::optional<double> overall() const { return rmse ? rmse : rms_surface_distance; }
};

/// All members of Errors, for loops over all errors.
inline constexpr std::optional<double> Errors::*kErrors[]{
    &Errors::rmse,          &Errors::rmse_object,      &Errors::rmse_height,
    &Errors::footprint_iou, &Errors::surface_distance, &Errors::rms_surface_distance,
    &Errors::f_score,       &Errors::coverage,         &Errors::volume_iou};

/// Reconstruction of one object of the scene.
struct ObjectErrors {
  int cells = 0;  ///< candidates that are on the object and not on a higher one
  /// Whether one component of predicted cells contains at least a fifth of this object and of another one, although the
  /// two true objects do not touch.
  bool merged = false;
  bool split = false;
  /// Intersection over union of the object's cells with its predicted cells. These are its own predicted cells, and the
  /// predicted cells off all objects whose nearest object cell belongs to it. Absent if the object has no cell.
  std::optional<double> iou;
  std::optional<double> rmse_height;  ///< metres, of the mean height over the object's cells
};

}  // namespace palpate
