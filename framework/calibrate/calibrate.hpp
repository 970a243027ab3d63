// SPDX-License-Identifier: MIT
// Calibration of the simulator's effects: they are fitted to the recorded taps of an arm.
#pragma once

#include "record/run_replay.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns a file of effects (`effects: ...`, as in configs/effects). The effects are fitted to recorded taps; the
/// objects must stand as the configs of the runs describe. The comments of the file have the interval and the source of
/// each value. The simulated error with the assumed effects is subtracted first. With the result, the simulator
/// therefore has the same mean error as the arm.
///
/// Throws Error with a remedy for fewer than 10 contacts, for runs that cannot be simulated, and for a scene that does
/// not match its config. A scene does not match if more than a fifth of a run's contacts differ by more than 1 cm from
/// all heights within 1 cm of their positions. It does not match either if more than a twentieth of the contacts (and
/// more than one) are that far below, or if the offset of all runs exceeds 3 cm.
std::string calibrate(const RunEnvironment& environment, const std::vector<RecordedRun>& recordings);

}  // namespace palpate
