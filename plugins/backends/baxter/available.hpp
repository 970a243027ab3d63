// SPDX-License-Identifier: MIT
// The plugin is there in every build, so that records of a robot can be read, replayed and listed anywhere; what it
// needs of ROS to move one may not be.
#pragma once

namespace palpate::baxter {

/// Whether this build can talk to a robot. Where it cannot, no option is mandatory: what is to be said first is then
/// what to install.
bool available();

}  // namespace palpate::baxter
