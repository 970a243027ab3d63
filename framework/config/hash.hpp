// SPDX-License-Identifier: MIT
// Hashes that identify runs and builds. They are not cryptographic.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Returns the 128 bits of XXH3 as 32 hexadecimal digits.
std::string hash_of(std::string_view bytes);

}  // namespace palpate
