// SPDX-License-Identifier: MIT
// What names a plugin's library in manifests.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// A hash, 32 hex digits, over what gets into memory of a shared library that this process can load: code and data with
/// their places. The table of symbols and that of sections, which a package is stripped of, do not count: the same
/// build is the same before and after. Throws Error if the file cannot be read or was cut short.
std::string hash_of_loaded(const std::filesystem::path& file);

}  // namespace palpate
