// SPDX-License-Identifier: MIT
// Numbers as people write them in configs, with and without unit, read strictly.
#pragma once

#include "config/tree.hpp"

#include <palpate/options.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// The length of the decimal number that `text` begins with, perhaps one too large for a double; 0 if it does not.
std::size_t decimal_length(std::string_view text);

/// Reads `1.7 cm` as 0.017. The value is the double nearest to the decimal as written, so that `17 mm`, `1.7 cm` and
/// `0.017 m` are the same bits. Throws Error at the tree's place for anything but a finite decimal with a unit of the
/// dimension: a bare number, another dimension, an octal or hexadecimal look, NaN, infinity.
double read_quantity(const Tree& tree, const std::string& name, Unit unit);

/// A number with whatever unit it has, in SI.
struct AnyQuantity {
  double value;
  Unit unit;
};

/// The same as read_quantity() where the dimension is not known beforehand; none for what is no quantity.
std::optional<AnyQuantity> any_quantity(const std::string& text);

/// Reads a whole number; same strictness.
std::int64_t read_integer(const Tree& tree, const std::string& name);

/// `0.017 m`, the shortest text that reads back as the same bits.
std::string write_quantity(double value, Unit unit);

/// A constant as a config has it: "none" for what is absent, "" for none.
std::string constant_text(const FixedValue& constant, Unit unit);

/// Several of them: a list.
Tree write_quantities(const double* values, std::size_t count, Unit unit);
/// Row after row of `columns`: a list of lists.
Tree write_table(const std::vector<double>& values, std::size_t columns, Unit unit);

/// "m", "s", "N", "rad", "m/s" or "".
std::string unit_symbol(Unit unit);

/// "a length", "a time", ... and the units that may be written, for messages and descriptions.
std::string dimension_name(Unit unit);
std::vector<std::string> unit_names(Unit unit);

}  // namespace palpate
