// SPDX-License-Identifier: MIT
#include "simulator/simulator.hpp"

namespace palpate::backends {

PALPATE_PLUGIN(Backend, Simulator, "simulator", "a simulated arm over the scene of the config")

}  // namespace palpate::backends
