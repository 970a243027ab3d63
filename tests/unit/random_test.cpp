// SPDX-License-Identifier: MIT
// Random numbers: those that the C++ standard fixes.
#include <palpate/random.hpp>

#include "support/testing.hpp"

#include <random>

namespace palpate {
namespace {

TEST(Random, GivesTheNumbersOfTheStandardsEngineThroughManyOfItsStates) {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    const auto mixed = [](std::uint64_t z) {
      z += 0x9e3779b97f4a7c15ULL;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
      return z ^ (z >> 31);
    };
    constexpr std::uint64_t kOfNoPurpose = 0xcbf29ce484222325ULL;
    std::mt19937_64 expected(mixed(mixed(mixed(seed) ^ kOfNoPurpose) ^ 3));
    Random random(seed, "", 3);
    for (int i = 0; i < 10000; ++i) ASSERT_EQ(random.bits(), expected()) << "draw " << i;
  }
}

TEST(Random, GoesOnFromACopyAsFromItself) {
  Random one(5, "random test");
  for (int i = 0; i < 700; ++i) one.bits();
  Random other = one;
  for (int i = 0; i < 700; ++i) ASSERT_EQ(one.bits(), other.bits());
}

}  // namespace
}  // namespace palpate
