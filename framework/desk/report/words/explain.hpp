// SPDX-License-Identifier: MIT
// Why a recorded run made a tap where it made it, in words.
#pragma once

#include "record/recording.hpp"

#include <string>

namespace palpate {

/// Some twenty lines on tap `tap`, from 1, of a recorded run: who chose it and by how much, the state of the models
/// that it was chosen from, what was expected and found, what it changed. All is what the record says, but for the
/// height that was expected, which is computed from the taps before. Throws Error where there is no such tap.
std::string explain_tap(const Workshop& workshop, const Recording& recording, int tap);

}  // namespace palpate
