// SPDX-License-Identifier: MIT
// The hash that identifies a plugin's library in manifests.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Returns a hash (32 hexadecimal digits) over the loaded parts of a shared library: code and data with their
/// addresses. `library`: all bytes of its file, which this process has loaded. The symbol and section tables, which
/// packages strip, are left out, so that a build has the same hash before and after packaging.
std::string hash_of_loaded(std::string_view library);

}  // namespace palpate
