// SPDX-License-Identifier: MIT
// Stub of the backend for builds without ROS. It has the options, so recorded runs of a robot can be read and replayed.
#include "stub.hpp"

#include "baxter/options.hpp"

#include <palpate/backend.hpp>

PALPATE_STUB_PLUGIN(palpate::Backend, palpate::baxter::BaxterOptions, "baxter",
                    "left arm of a Baxter robot, over ROS 1, which this build does not have")
