// SPDX-License-Identifier: MIT
// Random numbers without global state. A seed, a purpose and a number identify each stream. So parts of the program
// that draw random numbers do not affect each other, and a resumed run draws the same numbers as an uninterrupted run.
#pragma once

#include <palpate/math.hpp>

#include <cmath>
#include <cstdint>
#include <random>
#include <string_view>

namespace palpate {

/// A stream of random numbers of std::mt19937_64, whose output the C++ standard defines. The distributions are
/// palpate's own, because the standard does not define their output.
class Random {
 public:
  /// Streams with different (seed, purpose, number) are practically independent: FNV-1a and SplitMix64 mix the key
  /// before it seeds the engine.
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t number = 0) {
    std::uint64_t key = 0xcbf29ce484222325ULL;
    for (const char c : purpose) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    engine_.seed(mix(mix(mix(seed) ^ key) ^ number));
  }

  /// Returns 64 random bits.
  std::uint64_t bits() { return engine_(); }

  /// Returns a uniform number in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  /// Returns a standard normal number (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * math::log(1.0 - uniform()));
    return radius * math::cos(2.0 * 3.14159265358979323846 * uniform());
  }

  /// Returns a uniform integer in {0, ..., count - 1}; `count` > 0. Unbiased, because excess draws are rejected.
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
