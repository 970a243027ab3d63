// SPDX-License-Identifier: MIT
// What names a plugin's library in manifests.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// A hash, 32 hex digits, over what of a shared library gets into memory, code and data with their places. Symbols and
/// section tables, which a package is stripped of, do not count: the same build is the same before and after. Throws
/// Error if the file cannot be read or is not a library of this machine's kind.
std::string hash_of_loaded(const std::filesystem::path& file);

}  // namespace palpate
