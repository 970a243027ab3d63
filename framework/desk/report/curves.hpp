// SPDX-License-Identifier: MIT
// What is drawn of a run over its taps: the panels of `figures/curves.png` and of its page, which show the same
// numbers.
#pragma once

#include "report/history.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Values at every moment of a history, none where there is none.
struct Curve {
  std::string name;  ///< "" of the only one of a panel
  std::vector<std::optional<double>> values;
};

enum class CurveAxis {
  free,
  from_zero,
  share,        ///< from 0 to 1
  logarithmic,  ///< where the values differ much
};

/// Curves with one axis; there is at least one, each with at least one value that the axis can show.
struct CurvePanel {
  std::string title;
  std::string unit;  ///< "" for none
  CurveAxis axis = CurveAxis::from_zero;
  std::vector<Curve> curves;

  std::string full_title() const { return unit.empty() ? title : title + " [" + unit + "]"; }
};

/// The curves of a run.
struct Curves {
  std::vector<CurvePanel> panels;
  /// What would be a panel of level lines, as words: "Largest standard deviation of a height: 10 cm".
  std::vector<std::string> constants;
};

/// Errors, what is not known, shares, likelihoods, hyperparameters, what the footprint tells, times. What the run has
/// not is left out, and so is every panel none of whose curves ever changes.
Curves curves_of(const Recording& recording, const History& history);

}  // namespace palpate
