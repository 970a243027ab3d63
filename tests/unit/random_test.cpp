// SPDX-License-Identifier: MIT
// Streams of random numbers, beside the engine of the standard library.
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <random>
#include <string>

namespace palpate {
namespace {

/// How a key is mixed: FNV-1a of the purpose, and SplitMix64.
std::uint64_t key_of(std::uint64_t seed, const std::string& purpose, std::uint64_t number) {
  const auto mix = [](std::uint64_t z) {
    z += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  };
  std::uint64_t key = 0xcbf29ce484222325U;
  for (const char c : purpose) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return mix(mix(mix(seed) ^ key) ^ number);
}

TEST(Random, DrawsWhatTheEngineOfTheStandardDraws) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Random random(seed, "random test", 3 * seed);
    std::mt19937_64 engine(key_of(seed, "random test", 3 * seed));
    for (int i = 0; i < 2000; ++i) ASSERT_EQ(random.bits(), engine()) << seed << " " << i;
  }
}

}  // namespace
}  // namespace palpate
