// SPDX-License-Identifier: MIT
// The bytes of a mesh file, and the hash by which a config knows them again.
#pragma once

#include <string>

namespace palpate::shapes {

/// The whole file. Throws Error, its `where` the file: missing, not readable, no regular file, empty, or larger than
/// 500 MB.
std::string read_file(const std::string& file);

/// 128 bits of XXH3 as 32 hex digits.
std::string checksum_of(const std::string& bytes);

}  // namespace palpate::shapes
