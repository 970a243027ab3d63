// SPDX-License-Identifier: MIT
// The instruction set of all loops that are compiled for several (math/highway.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate::math {

/// The instruction sets that this processor has and loops are compiled for, the widest first: AVX-512, AVX2, NEON, and
/// baseline, which every processor has.
std::vector<std::string> instruction_sets();

/// All loops of this process use `name`, one of instruction_sets(), from now on. Not while loops are running.
void use_instructions(std::string_view name);

/// The name of the set in use: the widest, unless another was chosen.
std::string instructions_in_use();

/// Follows the environment variable PALPATE_INSTRUCTIONS: the widest set if it is unset or empty, the baseline if it is
/// `baseline`, so that runs on different machines give the same bytes. Returns the name of the set. Throws Error for any
/// other value.
std::string choose_instructions();

}  // namespace palpate::math
