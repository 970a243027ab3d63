// SPDX-License-Identifier: MIT
// Names of the quantities that beliefs offer and that acquisitions and backends read: arrays with one value per
// candidate, and single numbers. The set of names is open; your own belief may offer others.
#pragma once

#include <initializer_list>
#include <set>
#include <string>

namespace palpate {

/// Names of quantities: `{quantity::kUncertainty, quantity::kLabelMean}`.
using QuantitySet = std::set<std::string, std::less<>>;

/// Returns the quantities of both sets.
inline QuantitySet operator|(QuantitySet a, const QuantitySet& b) {
  a.insert(b.begin(), b.end());
  return a;
}

/// A quantity that a belief offers.
struct Quantity {
  std::string name;
  std::string meaning;  ///< a noun phrase, with the unit
};

namespace quantity {

// Offered by every shipped belief, with one value per candidate.
inline constexpr const char* kUncertainty = "uncertainty";         ///< variance relative to the prior, in [0, 1]
inline constexpr const char* kMeasurementStd = "measurement_std";  ///< standard deviation of a tap's height, metres

// Offered by the belief `height_map`, with one value per candidate.
inline constexpr const char* kLabelMean =
    "label_mean";  ///< w: mean of the label GP, clipped with `label: {clip: true}`
/// p: probability of an object, from the footprint.
inline constexpr const char* kObjectProbability = "object_probability";
inline constexpr const char* kHeightMean = "height_mean";      ///< mean of the surface, metres
inline constexpr const char* kHeightStd = "height_std";        ///< standard deviation of the surface, metres
inline constexpr const char* kHypotheses = "hypotheses";       ///< available by BeliefView::hypotheses()
inline constexpr const char* kDeskPosition = "desk_position";  ///< the candidates are fixed positions on the desk

// Offered by the belief `solids`, with one value per candidate.
/// Distance along the line to the contact, metres.
inline constexpr const char* kExpectedDistance = "expected_distance";
/// Standard deviation of the surface at the contact, along the surface normal, metres.
inline constexpr const char* kSurfaceStd = "surface_std";
/// Cosine of the angle between line and surface normal, in [0, 1].
inline constexpr const char* kIncidenceCosine = "incidence_cosine";
inline constexpr const char* kExpectedDiscovery = "expected_discovery";  ///< see SolidsBelief
inline constexpr const char* kStdReduction = "std_reduction";            ///< see SolidsBelief

// Offered as single numbers.
inline constexpr const char* kExpectedRmse = "expected_rmse";  ///< expected RMSE of the reconstruction, metres
/// Probability of an object that no tap has touched.
inline constexpr const char* kUndiscoveredProbability = "undiscovered_probability";
inline constexpr const char* kObjectSeen = "object_seen";  ///< 1 if a camera saw an object before the first tap

}  // namespace quantity
}  // namespace palpate
