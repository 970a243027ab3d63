// SPDX-License-Identifier: MIT
#include "config/hash.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <fstream>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate {

std::string hash_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string hash_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  std::string bytes(in ? static_cast<std::size_t>(in.tellg()) : 0, '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw Error(file.string(), "cannot be read");
  return hash_of(bytes);
}

}  // namespace palpate
