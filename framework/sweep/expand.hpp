// SPDX-License-Identifier: MIT
// Many runs from one config: which values each key takes, and every combination of them.
#pragma once

#include "config/compose.hpp"
#include "config/tree.hpp"

#include <string>
#include <vector>

namespace palpate {

/// A key that is swept, and its values in order.
struct Axis {
  std::string key;  ///< dotted path
  std::vector<Tree> values;
};

/// One combination: a value for each axis, in the order of the axes.
using Combination = std::vector<Override>;

/// The values of a list, of `range(first, end)`, `range(first, end, step)` (end excluded) or of
/// `log(first, last, count)` (both included, evenly spaced in the logarithm; both with the same unit); any other value
/// is the only one. Throws Error.
std::vector<Tree> expand_values(const Tree& value, const std::string& key);

/// The axes of `sweep: {grid: {...}}`. Throws Error for anything else in it.
std::vector<Axis> config_axes(const Tree& sweep);

/// `KEY=V1,V2`, `KEY=[V1, V2]`, `KEY=range(0,10)`, `KEY=log(1cm,5cm,8)`: as typed behind `palpate sweep`. A list among
/// several values is one value.
Axis parse_axis(const std::string& text);

/// The product of the axes; the last axis runs fastest. Throws Error beyond a million combinations.
std::vector<Combination> product(const std::vector<Axis>& axes);

/// The text of a swept value as it stands in results.csv.
std::string value_text(const Tree& value);

}  // namespace palpate
