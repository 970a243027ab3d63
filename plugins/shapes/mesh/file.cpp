// SPDX-License-Identifier: MIT
#include "file.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::shapes {

namespace fs = std::filesystem;

std::string read_file(const std::string& file) {
  constexpr std::uintmax_t kMostBytes = 500'000'000;
  std::error_code trouble;
  const fs::file_status status = fs::status(file, trouble);
  if (status.type() == fs::file_type::not_found) {
    std::string hint;
    if (fs::path(file).is_relative())
      hint = "a relative path starts in the current folder, " + fs::current_path().string();
    throw Error(file, "no such file", hint);
  }
  if (status.type() != fs::file_type::regular) {
    throw Error(file, trouble ? trouble.message() : "not a regular file", "name a file in the format STL, OBJ or PLY");
  }
  const std::uintmax_t size = fs::file_size(file, trouble);
  if (!trouble && size > kMostBytes) {
    throw Error(file, "has " + std::to_string(size / 1'000'000) + " MB, at most 500 are read",
                "reduce the number of triangles");
  }
  std::ifstream in(file, std::ios::binary);
  std::string bytes(trouble ? 0 : size, '\0');
  if (trouble || !in || !in.read(bytes.data(), static_cast<std::streamsize>(size))) {
    throw Error(file, std::string("cannot be read: ") + std::strerror(errno));
  }
  if (bytes.empty()) throw Error(file, "is empty", "export it again");
  return bytes;
}

std::string checksum_of(const std::string& bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  char digits[33];
  std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return digits;
}

}  // namespace palpate::shapes
