// SPDX-License-Identifier: MIT
// Random numbers without global state: a stream is named by a seed, a purpose and a number, so that no consumer can
// disturb another and a resumed run draws what the unbroken one would have drawn.
#pragma once

#include <palpate/simd.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate {

/// A stream of random numbers (those of std::mt19937_64, whose output the C++ standard fixes; made all at once when the
/// last one is used up, which vectors do in a fifth of the instructions. Distributions are our own, because those of
/// the library are not fixed).
class Random {
 public:
  /// Streams of different (seed, purpose, number) are independent for all that matters here: the key is mixed by
  /// FNV-1a and SplitMix64 before it seeds the engine.
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t number = 0) {
    std::uint64_t key = 0xcbf29ce484222325ULL;
    for (const char c : purpose) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    key = mix(mix(mix(seed) ^ key) ^ number);
    for (std::uint64_t i = 0; i < kState; key = 6364136223846793005ULL * (key ^ (key >> 62)) + ++i) state_[i] = key;
  }

  /// 64 random bits.
  std::uint64_t bits() {
    if (next_ == kState) refill();
    return ready_[next_++];
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

  /// The next state, and what is drawn from it (Nishimura and Matsumoto 2000).
  void refill() {
    const simd::Lanes lanes = simd::widest();
    std::uint64_t* const out = ready_;
    std::uint64_t* const state = state_;
    const auto twisted = [](std::uint64_t one, std::uint64_t next, std::uint64_t far) {
      const std::uint64_t both = (one & ~std::uint64_t{0x7fffffff}) | (next & 0x7fffffff);
      return far ^ (both >> 1) ^ (-(both & 1) & 0xb5026f5aa96619e9ULL);
    };
    simd::for_each(lanes, kHalf, [=](std::ptrdiff_t i) { out[i] = twisted(state[i], state[i + 1], state[i + kHalf]); });
    state[kState] = out[0];
    simd::for_each(lanes, kHalf,
                   [=](std::ptrdiff_t i) { out[i + kHalf] = twisted(state[i + kHalf], state[i + kHalf + 1], out[i]); });
    simd::for_each(lanes, kState, [=](std::ptrdiff_t i) {
      std::uint64_t bits = state[i] = out[i];
      bits ^= (bits >> 29) & 0x5555555555555555ULL;
      bits ^= (bits << 17) & 0x71d67fffeda60000ULL;
      bits ^= (bits << 37) & 0xfff7eee000000000ULL;
      out[i] = bits ^ (bits >> 43);
    });
    next_ = 0;
  }

  static constexpr int kState = 312;
  static constexpr int kHalf = kState / 2;
  std::uint64_t state_[kState + 1];  ///< the last: room for the first of the next state
  std::uint64_t ready_[kState];
  int next_ = kState;
};

}  // namespace palpate
