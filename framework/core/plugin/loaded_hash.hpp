// SPDX-License-Identifier: MIT
// What names a plugin's library in manifests.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// A hash, 32 hex digits, over what gets into memory of a shared library that this process has loaded, all of its file:
/// code and data with their places. The table of symbols and that of sections, which a package is stripped of, do not
/// count: the same build is the same before and after.
std::string hash_of_loaded(std::string_view library);

}  // namespace palpate
