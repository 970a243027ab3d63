// SPDX-License-Identifier: MIT
// One outline of a belief, with all that is asked about it again and again.
#pragma once

#include "depths.hpp"
#include "proposals.hpp"

namespace palpate::footprints {

/// An outline, and what its moves ask for. It is that of after its push.
struct Particle : State {
  bool blurred = false;
  int mistakes = 0;      ///< touches so far that it has wrong
  double labels = 0.0;   ///< what the labels of all of them say against it
  double heights = 0.0;  ///< what their heights say for it
  Depths depths;         ///< of each touch
};

}  // namespace palpate::footprints
