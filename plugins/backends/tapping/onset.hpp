// SPDX-License-Identifier: MIT
// Where a contact began, found from what was felt before and after it was noticed.
#pragma once

#include <optional>
#include <vector>

namespace palpate::tapping {

/// One sample of a descent: the height of the tip, metres, and the force, newtons.
struct Sample {
  double height;
  double force;
};

/// The height at which the force begins to rise: the kink of the hinge force = zero + slope * max(0, kink - height)
/// that is nearest to `samples` in the sense of least squares, zero and slope being free. The height at which a
/// threshold is crossed lies lower by threshold / stiffness, and by what the arm moves while one makes sure; the kink
/// does not, and the noise of a single sample is averaged out.
/// None when there are fewer than four samples or no slope makes the force rise with the depth. Where every kink within
/// an interval fits as well (a rigid surface, met between two samples), the lowest.
std::optional<double> onset(const std::vector<Sample>& samples);

/// The onset of the contact with which `descent` ends, its samples in the order of time. Only its last part is looked
/// at, since the zero of the force may wander on the way: as much as shows the whole rise, which is long on a soft
/// object, with air above it.
std::optional<double> onset_of_descent(const std::vector<Sample>& descent);

}  // namespace palpate::tapping
