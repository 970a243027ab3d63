// SPDX-License-Identifier: MIT
// Hashes that name runs and builds. Not meant to resist anyone, only to tell things apart.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// 128 bits of XXH3 as 32 hex digits.
std::string hash_of(std::string_view bytes);

}  // namespace palpate
