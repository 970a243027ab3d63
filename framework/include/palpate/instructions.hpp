// SPDX-License-Identifier: MIT
// The instruction set of loops that are compiled for several, as those of palpate/math.hpp. A library has its own copy
// of this choice: when a plugin is created, it follows its run (Context::instructions).
#pragma once

namespace palpate {

/// In ascending order of width.
enum class Instructions {
  baseline,  ///< those of every processor
  neon,      ///< 64-bit ARM
  avx2,      ///< x86 with AVX2 and fused multiplications and additions
  avx512,
};

/// The widest set of this processor, unless use_instructions() chose another.
Instructions instructions_in_use();
/// `set` has to be one that this processor has.
void use_instructions(Instructions set);

}  // namespace palpate
