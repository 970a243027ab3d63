// SPDX-License-Identifier: MIT
// The settings among which `palpate tune` searches, as points.
#pragma once

#include "tune/description.hpp"

#include <palpate/random.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A setting: one coordinate per tuned key. For a list, the coordinate is the index of a value. For a range, it is the
/// position in the range, 0 to 1, on the scale of the range (linear or logarithmic).
using Point = std::vector<double>;

class SearchSpace {
 public:
  /// `is_whole`: for each key, whether its option takes whole numbers only. Throws Error for a range of whole
  /// numbers that contains none.
  SearchSpace(const std::vector<TunedKey>& keys, std::vector<bool> is_whole);

  /// Returns whether all keys have lists, so that there are only finitely many settings.
  bool is_finite() const;

  /// Returns all settings of lists; the last key varies fastest. Throws Error for more than 10000 settings.
  std::vector<Point> grid() const;
  /// Returns the first `count` points of a Sobol sequence. Lists are dimensions of the sequence, too.
  std::vector<Point> sobol(std::size_t count) const;
  /// Returns a random setting near `parent`. To each coordinate of a range, adds a normal number with the standard
  /// deviation `spread` times 0.5, 1 or 2, with equal probability; the result is clipped to the range. Draws each value
  /// of a list anew with probability 0.1.
  Point near(const Point& parent, double spread, Random& random) const;

  /// Returns the value of a key, as in a config. Values of ranges have six significant digits.
  Tree value(std::size_t key, double coordinate) const;
  /// Returns the coordinate of a value that was written in a config or by value(), clipped to the range. Returns
  /// nullopt for a value that is not in the list, and for a value that is not a quantity.
  std::optional<double> coordinate(std::size_t key, const std::string& text) const;

 private:
  const std::vector<TunedKey>& keys_;
  std::vector<bool> is_whole_;
};

}  // namespace palpate
