// SPDX-License-Identifier: MIT
// The curves of a run over its taps, which `figures/curves.png` and the page of the run show.
#pragma once

#include "report/history.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A curve with one value per moment of a history (before the first tap and after each tap); nullopt where the run has
/// no value.
struct Curve {
  std::string name;  ///< "" for the only curve of a panel
  std::vector<std::optional<double>> values;
};

enum class ValueAxisScale {
  free,
  from_zero,
  share,        ///< from 0 to 1
  logarithmic,  ///< for values that span orders of magnitude
};

/// Curves with a common axis. A panel has at least one curve, and each curve has at least one value that the axis can
/// show.
struct CurvePanel {
  std::string title;
  std::string unit;  ///< "" for no unit
  ValueAxisScale axis = ValueAxisScale::from_zero;
  std::vector<Curve> curves;

  std::string full_title() const { return unit.empty() ? title : title + " [" + unit + "]"; }
};

/// All curves of a run.
struct Curves {
  std::vector<CurvePanel> panels;
  /// Panels whose curves are constant, as texts: "Largest standard deviation of a height: 10 cm".
  std::vector<std::string> constants;
};

/// Returns panels of errors, standard deviations, shares, likelihoods, hyperparameters, numbers of the footprint and
/// times. Quantities that the run does not have are left out. Panels whose curves do not change become constants.
Curves curves_of(const RecordedRun& recording, const History& history);

}  // namespace palpate
