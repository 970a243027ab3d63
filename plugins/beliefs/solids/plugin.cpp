// SPDX-License-Identifier: MIT
#include "solids/solids_belief.hpp"

namespace palpate {

PALPATE_PLUGIN(Belief, SolidsBelief, "solids", "closed surfaces of solids, for taps from any side")

}  // namespace palpate
