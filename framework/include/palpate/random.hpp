// SPDX-License-Identifier: MIT
// Random numbers without global state: a stream is named by a seed, a purpose and a number, so that no consumer can
// disturb another and a resumed run draws what the unbroken one would have drawn.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace palpate {

/// A stream of random numbers: those of std::mt19937_64, whose output the C++ standard fixes. The standard does not fix
/// distributions, so these are palpate's own.
class Random {
 public:
  /// Streams of different (seed, purpose, number) are independent for all that matters here: the key is mixed by
  /// FNV-1a and SplitMix64 before it seeds the engine.
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t number = 0) {
    std::uint64_t key = 0xcbf29ce484222325ULL;
    for (const char c : purpose) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    engine_.seed(mix(mix(mix(seed) ^ key) ^ number));
  }

  /// 64 random bits.
  std::uint64_t bits() { return engine_(); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  /// Uniform in {0, ..., count - 1}; `count` > 0. Unbiased: draws again rather than folding.
  std::uint64_t index(std::uint64_t count) {
    const std::uint64_t excess = (0 - count) % count;
    std::uint64_t draw = bits();
    while (draw < excess) draw = bits();
    return draw % count;
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
};

}  // namespace palpate
