// SPDX-License-Identifier: MIT
// Reader for masses in the URDF description of a robot.
#pragma once

#include <optional>
#include <string>

namespace palpate::baxter {

/// Returns the total mass in kg of all links that are attached to `link` by joints, directly or through other links.
/// The mass of `link` itself is not included. Returns nullopt if `link` does not exist, if a mass is not a number of at
/// least 0, or if the text is not URDF.
std::optional<double> mass_beyond(const std::string& urdf, const std::string& link);

}  // namespace palpate::baxter
