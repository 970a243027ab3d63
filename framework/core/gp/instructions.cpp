// SPDX-License-Identifier: MIT
#include "gp/instructions.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

namespace palpate {

simd::Lanes lanes_in_use() {
  const char* const name = "PALPATE_INSTRUCTIONS";
  const char* const value = std::getenv(name);
  const std::string_view chosen = value != nullptr ? value : "";
  if (chosen.empty()) return simd::widest();
  if (chosen == "baseline") return simd::Lanes::sse2;
  throw Error(name, fmt::format("unknown value '{}'", chosen), "write baseline, or unset it");
}

const simd::Table& loops_in_use() { return simd::table_of(lanes_in_use()); }

}  // namespace palpate
