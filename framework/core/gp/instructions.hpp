// SPDX-License-Identifier: MIT
// The instructions that loops over candidates use: the widest that this processor has or, with the environment variable
// PALPATE_INSTRUCTIONS=baseline, those of every x86-64, so that runs on different machines give the same bytes.
#pragma once

#include "gp/simd/table.hpp"

namespace palpate {

/// Returns the widest lanes to use. Throws Error if PALPATE_INSTRUCTIONS is neither unset, empty nor `baseline`.
simd::Lanes lanes_in_use();

/// Returns the loops that use these lanes. Throws Error as lanes_in_use() does.
const simd::Table& loops_in_use();

}  // namespace palpate
