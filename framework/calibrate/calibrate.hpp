// SPDX-License-Identifier: MIT
// Calibration of the simulator's effects to the recorded taps of an arm.
#pragma once

#include "record/run_replay.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns a file of effects (`effects: ...`, as in configs/effects), fitted to taps of scenes that stand as in their
/// configs. Comments have the interval and the source of each value. The simulated error with the assumed effects is
/// subtracted first, so that the simulator has the arm's mean error with the result.
///
/// Throws Error with a remedy for fewer than 10 contacts, for runs that cannot be simulated, and for a scene that did
/// not stand as in its config. This is so if more than a fifth of a run's contacts differ by more than 1 cm from all
/// heights within 1 cm of their positions, if more than a twentieth (and more than one) are that far below, or if the
/// offset of all runs exceeds 3 cm.
std::string calibrate(const RunEnvironment& environment, const std::vector<RecordedRun>& recordings);

}  // namespace palpate
