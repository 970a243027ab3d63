// SPDX-License-Identifier: MIT
// Which bytes are text: files in formats that demand UTF-8 are written through this.
#pragma once

#include <cstddef>
#include <string_view>

namespace palpate {

/// The length of the UTF-8 sequence that `text` begins with; 0 if it is not valid (RFC 3629). `text` is not empty.
std::size_t utf8_length(std::string_view text);

}  // namespace palpate
