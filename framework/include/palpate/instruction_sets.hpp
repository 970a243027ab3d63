// SPDX-License-Identifier: MIT
// The instruction set of loops that are compiled for several sets, such as those of palpate/math.hpp. Each library has
// its own copy of this setting. When a plugin is created, it gets the instruction set of its run
// (Context::instructions).
#pragma once

namespace palpate {

/// In ascending order of width.
enum class Instructions {
  baseline,  ///< instructions of every processor
  neon,      ///< 64-bit ARM
  avx2,      ///< x86 with AVX2 and fused multiplications and additions
  avx512,
};

/// Returns the set in use: the set that use_instructions() selected last, or else the widest set of this processor.
Instructions instructions_in_use();
/// Selects the set in use. This processor must support it.
void use_instructions(Instructions set);

}  // namespace palpate
