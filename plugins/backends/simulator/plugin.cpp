// SPDX-License-Identifier: MIT
#include "simulator/simulator.hpp"

namespace palpate::backends {

PALPATE_PLUGIN(Backend, Simulator, "simulator", "simulated arm in the scene of the config")

}  // namespace palpate::backends
