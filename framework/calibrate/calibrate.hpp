// SPDX-License-Identifier: MIT
// Calibration: fits the simulator's effects (deviations from a perfect tap) to the recorded taps of an arm.
#pragma once

#include "record/run_replay.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns the text of an effects file (`effects: ...`, as in configs/effects). The effects are fitted to recorded
/// taps. During these taps, the objects must have been at the positions given in the configs of the runs. Comments in
/// the file give the interval and the source of each value. Some effects are assumed. Their simulated errors are
/// subtracted before the fit. With all effects of the file, the simulator therefore has the same mean error as the arm.
///
/// Throws Error with a remedy for fewer than 10 contacts, for runs that cannot be simulated, and for a scene that does
/// not match its config. A scene does not match in any of these cases:
/// - More than a fifth of a run's contacts differ by more than 1 cm from all heights within 1 cm of their positions.
/// - More than a twentieth of a run's contacts, and at least two, are more than 1 cm below all these heights.
/// - The common offset of all runs exceeds 3 cm.
std::string calibrate(const RunEnvironment& environment, const std::vector<RecordedRun>& recordings);

}  // namespace palpate
