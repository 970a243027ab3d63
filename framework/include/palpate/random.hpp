// SPDX-License-Identifier: MIT
// Random numbers without global state: a stream is named by a seed, a purpose and a number, so that no consumer can
// disturb another and a resumed run draws what the unbroken one would have drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate {

/// A stream of random numbers (those of std::mt19937_64, whose output the C++ standard fixes; distributions are our
/// own, because those of the library are not fixed).
class Random {
 public:
  /// Streams of different (seed, purpose, number) are independent for all that matters here: the key is mixed by
  /// FNV-1a and SplitMix64 before it seeds the engine.
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t number = 0) {
    std::uint64_t key = 0xcbf29ce484222325ULL;
    for (const char c : purpose) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    std::uint64_t word = mix(mix(mix(seed) ^ key) ^ number);
    for (std::size_t i = 0; i < kWords; ++i) {
      if (i > 0) word = 6364136223846793005ULL * (word ^ word >> 62) + i;
      words_[i] = word;
    }
  }

  /// 64 random bits.
  std::uint64_t bits() {
    if (next_ == kWords) refill();
    std::uint64_t out = words_[next_++];
    out ^= out >> 29 & 0x5555555555555555ULL;
    out ^= out << 17 & 0x71d67fffeda60000ULL;
    out ^= out << 37 & 0xfff7eee000000000ULL;
    return out ^ out >> 43;
  }

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

  // Matsumoto and Nishimura (1998), Nishimura (2000). Written out, because the loops of the library's are no vectors.
  static constexpr std::size_t kWords = 312;
  static constexpr std::size_t kShift = 156;
  static std::uint64_t twist(std::uint64_t high, std::uint64_t low, std::uint64_t other) {
    const std::uint64_t both = (high & ~0x7fffffffULL) | (low & 0x7fffffffULL);
    return other ^ both >> 1 ^ ((0 - (both & 1)) & 0xb5026f5aa96619e9ULL);
  }
  void refill() {
    for (std::size_t i = 0; i < kWords - kShift; ++i) words_[i] = twist(words_[i], words_[i + 1], words_[i + kShift]);
    for (std::size_t i = kWords - kShift; i < kWords - 1; ++i)
      words_[i] = twist(words_[i], words_[i + 1], words_[i + kShift - kWords]);
    words_[kWords - 1] = twist(words_[kWords - 1], words_[0], words_[kShift - 1]);
    next_ = 0;
  }

  std::uint64_t words_[kWords];
  std::size_t next_ = kWords;
};

}  // namespace palpate
