// SPDX-License-Identifier: MIT
// The check of what the readers of a run read.
#pragma once

#include <palpate/belief.hpp>

#include <string>

namespace palpate {

/// Removes the quantities that `belief` does not offer from an optional reader.
void leave_out_unoffered(ReadPlan::Reader& reader, const Belief& belief);

/// Throws Error for a reader of a quantity that `belief`, by its `name`, does not offer.
void require_offered(const ReadPlan& plan, const Belief& belief, const std::string& name);

}  // namespace palpate
