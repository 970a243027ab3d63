// SPDX-License-Identifier: MIT
// Effects with which the simulator errs as the arm of some recorded taps does.
#pragma once

#include "record/recording.hpp"

#include <string>
#include <vector>

namespace palpate {

/// A file of effects (`effects: ...`, as configs/effects has them) from taps of scenes that stand where their configs
/// have them: each value with its interval and what it comes from, as comments. What the simulator's arm adds to the
/// same taps by what is assumed is taken out first, so that the simulator comes to the same mean error with the result.
/// Throws Error, with the remedy, for fewer than 10 contacts, for runs that no simulator can repeat, and for a scene
/// that did not stand as its config says: more than a fifth of a run's contacts are more than 1 cm off all heights
/// within 1 cm of their places, more than a twentieth (and not one alone) are so below them, or the offset of all runs
/// exceeds 3 cm.
std::string calibrate(const Workshop& workshop, const std::vector<Recording>& recordings);

}  // namespace palpate
