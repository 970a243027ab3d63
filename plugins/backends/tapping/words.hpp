// SPDX-License-Identifier: MIT
// A tap in words, for a person who decides whether it is made.
#pragma once

#include "tapping/motion.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate::tapping {

/// Rounded to a millimetre and to a tenth of a newton: "13.5 cm", "6.0 N".
std::string centimetres(double length);
std::string newtons(double force);
/// "(11.5, 3.0) cm"
std::string place(const Target& target);

/// The way there from `from` (none: it is not known), the descent, and the force that ends it; a line each.
std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from);

}  // namespace palpate::tapping
