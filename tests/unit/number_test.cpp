// SPDX-License-Identifier: MIT
#include "record/number.hpp"

#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace palpate::test {
namespace {

std::string text_by(char* (*write)(char*, double), double value) {
  std::array<char, kLongestNumber> text;
  return {text.data(), write(text.data(), value)};
}

std::string by_the_standard_library(double value) {
  std::array<char, 2 * kLongestNumber> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Numbers of any bits, and those of few digits and of any power of ten, around which the notations part.
template <class Visit>
void for_numbers(const Visit& visit) {
  std::mt19937_64 random(8);
  for (int i = 0; i < (brief() ? 20000 : 200000); ++i) {
    const std::uint64_t pattern = random();
    double value = 0.0;
    std::memcpy(&value, &pattern, sizeof value);
    if (std::isfinite(value)) visit(value);
    const double power = std::pow(10.0, static_cast<double>(random() % 60) - 30.0);
    const auto few = static_cast<double>(1 + random() % 999);
    const double share = static_cast<double>(random() >> 11) * 0x1.0p-53;
    for (const double one : {few * power, few / power, -few * power, share * power}) {
      visit(one);
      visit(std::nextafter(one, 0.0));
    }
  }
  for (const double limit : {1e-5, 1e-4, 1e-3, 1e5, 1e15, 1e16, 1e100, 1e-100, 9007199254740993.0, 5e-324,
                             std::numeric_limits<double>::min(), std::numeric_limits<double>::max()}) {
    for (const double value : {limit, std::nextafter(limit, 0.0), std::nextafter(limit, 2.0 * limit)}) {
      if (!std::isfinite(value)) continue;
      visit(value);
      visit(-value);
    }
  }
  visit(0.0);
  visit(-0.0);
}

TEST(Number, IsWrittenToTheLetterAsFmtWritesIt) {
  for_numbers([](double value) { ASSERT_EQ(text_by(write_number, value), fmt::format("{}", value)); });
}

TEST(Number, IsWrittenInMapsToTheLetterAsTheStandardLibraryWritesIt) {
  for_numbers([](double value) { ASSERT_EQ(text_by(write_shortest, value), by_the_standard_library(value)); });
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const double value : {std::nan(""), -std::nan(""), kEndless, -kEndless})
    EXPECT_EQ(text_by(write_shortest, value), by_the_standard_library(value));
}

}  // namespace
}  // namespace palpate::test
