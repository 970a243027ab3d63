// SPDX-License-Identifier: MIT
// The backend of a build without ROS: what a robot recorded elsewhere can be read and replayed here.
#include "absent.hpp"

#include "baxter/options.hpp"

#include <palpate/backend.hpp>

PALPATE_ABSENT_PLUGIN(palpate::Backend, palpate::baxter::BaxterOptions, "baxter",
                      "left arm of a Baxter robot, over ROS 1, which this build does not have")
