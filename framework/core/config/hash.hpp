// SPDX-License-Identifier: MIT
// Hashes that name runs and builds. Not meant to resist anyone, only to tell things apart.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// 128 bits of XXH3 as 32 hex digits.
std::string hash_of(std::string_view bytes);

/// The same of a file's content; throws Error if it cannot be read.
std::string hash_of_file(const std::filesystem::path& file);

}  // namespace palpate
