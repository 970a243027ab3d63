// SPDX-License-Identifier: MIT
#include "config/hash.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <array>
#include <fstream>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate {
namespace {

std::string digits(const XXH128_hash_t& hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

}  // namespace

std::string hash_of(std::string_view bytes) { return digits(XXH3_128bits(bytes.data(), bytes.size())); }

std::string hash_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 1 << 15> piece;
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  while (in) {
    in.read(piece.data(), piece.size());
    XXH3_128bits_update(&state, piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) throw Error(file.string(), "cannot be read");
  return digits(XXH3_128bits_digest(&state));
}

}  // namespace palpate
