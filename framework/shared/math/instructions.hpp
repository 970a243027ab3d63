// SPDX-License-Identifier: MIT
// Names instruction sets, selects a set by an environment variable, and returns the version of a loop for the selected
// set.
#pragma once

#include <palpate/instruction_sets.hpp>

#include <array>
#include <vector>

namespace palpate::math {

/// Returns the name of a set: "AVX-512", "AVX2", "NEON" or "baseline".
const char* name_of(Instructions set);

/// Returns the sets of this processor for which loops are compiled, the widest first.
std::vector<Instructions> instruction_sets();

/// Selects the set that the environment variable PALPATE_INSTRUCTIONS names, or the widest set if the variable is unset
/// or empty. Loops give the same bytes with AVX2, AVX-512 and NEON. With `baseline`, the last digits differ, because
/// this set has no fused multiply-add. Throws Error if the processor has no set with this name.
Instructions choose_instructions();

/// Returns the version of a function for the set in use. `versions` contains one pointer per set, in the order of
/// Instructions; null if the version is not compiled.
template <class Function>
Function version_of(const std::array<Function, 4>& versions) {
  const Function own = versions[static_cast<std::size_t>(instructions_in_use())];
  return own != nullptr ? own : versions[0];
}

}  // namespace palpate::math
