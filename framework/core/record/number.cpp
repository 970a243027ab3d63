// SPDX-License-Identifier: MIT
#include "record/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace palpate {
namespace {

/// A number above 0: its digits, and how many of them stand before the point, where 0 or less is how many zeros follow
/// it.
class Digits {
 public:
  explicit Digits(double value) : Digits(fmt::detail::dragonbox::to_decimal(value)) {}

  int count() const { return static_cast<int>(text_.size()); }
  int before_point() const { return before_point_; }
  int exponent() const { return before_point_ - 1; }

  int plain_length() const {
    if (before_point_ <= 0) return 2 - before_point_ + count();
    return before_point_ >= count() ? before_point_ : count() + 1;
  }
  int exponent_length() const { return count() + (count() > 1 ? 1 : 0) + (std::abs(exponent()) < 100 ? 4 : 5); }

  char* write_plain(char* to) const {
    if (before_point_ <= 0) {
      std::copy_n("0.0000", 6, to);  // as few as are written without an exponent
      return write(to + 2 - before_point_, 0, count());
    }
    const int whole = std::min(before_point_, count());
    to = write(to, 0, whole);
    if (before_point_ >= count()) return std::fill_n(to, before_point_ - count(), '0');
    *to = '.';
    return write(to + 1, whole, count());
  }

  char* write_with_exponent(char* to) const {
    *to++ = text_.data()[0];
    if (count() > 1) *to++ = '.';
    to = write(to, 1, count());
    *to++ = 'e';
    *to++ = exponent() < 0 ? '-' : '+';
    const fmt::format_int size(std::abs(exponent()));
    if (size.size() == 1) *to++ = '0';
    return std::copy_n(size.data(), size.size(), to);
  }

 private:
  explicit Digits(const fmt::detail::dragonbox::decimal_fp<double>& decimal)
      : text_(decimal.significand), before_point_(decimal.exponent + count()) {}

  char* write(char* to, int from, int end) const { return std::copy(text_.data() + from, text_.data() + end, to); }

  fmt::format_int text_;
  int before_point_;
};

/// `plain` says of the digits whether they are written without an exponent.
template <class Plain>
char* write(char* to, double value, const Plain& plain) {
  if (std::signbit(value)) *to++ = '-';
  if (value == 0.0) return *to = '0', to + 1;
  const Digits digits(std::abs(value));
  return plain(digits) ? digits.write_plain(to) : digits.write_with_exponent(to);
}

}  // namespace

char* write_number(char* to, double value) {
  return write(to, value, [](const Digits& digits) { return digits.exponent() >= -4 && digits.exponent() < 16; });
}

char* write_shortest(char* to, double value) {
  // Of large numbers it writes more digits than are needed.
  if (!(std::abs(value) < 1e15)) return std::to_chars(to, to + kLongestNumber, value).ptr;
  return write(to, value, [](const Digits& digits) { return digits.plain_length() <= digits.exponent_length(); });
}

}  // namespace palpate
