// SPDX-License-Identifier: MIT
// The check of what the readers of a run read.
#pragma once

#include <palpate/belief.hpp>

#include <string>

namespace palpate {

/// Throws Error for a reader of a quantity that `belief`, by its `name`, does not offer.
void require_offered(const ReadPlan& plan, const Belief& belief, const std::string& name);

}  // namespace palpate
