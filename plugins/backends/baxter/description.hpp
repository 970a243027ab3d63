// SPDX-License-Identifier: MIT
// What is read of a robot's own description of itself (URDF).
#pragma once

#include <optional>
#include <string>

namespace palpate::baxter {

/// The mass of all links that hang on `link` by joints, directly or through others, without its own; kg. None if the
/// text has no such link, or a mass below it that is no number from 0 on. A text that is no URDF has no links.
std::optional<double> mass_beyond(const std::string& urdf, const std::string& link);

}  // namespace palpate::baxter
