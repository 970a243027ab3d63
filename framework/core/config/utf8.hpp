// SPDX-License-Identifier: MIT
// Which bytes are text: what is read has to be UTF-8, and files in formats that demand it are written through this.
#pragma once

#include <cstddef>
#include <string_view>

namespace palpate {

/// The length of the UTF-8 sequence that `text` begins with; 0 if it is not valid (RFC 3629). `text` is not empty.
std::size_t utf8_length(std::string_view text);

/// How many of the first bytes are valid: all of them, or the place of the first that is not.
std::size_t utf8_prefix(std::string_view text);

}  // namespace palpate
