// SPDX-License-Identifier: MIT
// Checks that the belief offers all quantities that the parts of a run read.
#pragma once

#include <palpate/belief.hpp>

#include <string>

namespace palpate {

/// Removes from `reader`, an optional reader, the quantities that `belief` does not offer.
void leave_out_unoffered(ReadPlan::Reader& reader, const Belief& belief);

/// Throws Error if a reader reads a quantity that `belief`, named `name`, does not offer.
void require_offered(const ReadPlan& plan, const Belief& belief, const std::string& name);

}  // namespace palpate
