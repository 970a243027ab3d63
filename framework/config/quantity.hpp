// SPDX-License-Identifier: MIT
// Parses quantities and numbers in configs strictly, and writes them.
#pragma once

#include "config/tree.hpp"

#include <palpate/options.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Returns the length of the decimal number at the beginning of `text`, even if it is too large for a double; 0 if
/// there is none.
std::size_t decimal_length(std::string_view text);

/// Reads `1.7 cm` as 0.017. The value is the double nearest to the written decimal, so that `17 mm`, `1.7 cm` and
/// `0.017 m` give the same bits. Throws Error, with the source location of `tree`, for anything but a finite decimal
/// with a unit of the right dimension.
double read_quantity(const Tree& tree, const std::string& name, Unit unit);

/// A number in SI units, and its unit.
struct AnyQuantity {
  double value;
  Unit unit;
};

/// Reads a quantity of any dimension; nullopt if `text` is not a quantity.
std::optional<AnyQuantity> any_quantity(const std::string& text);

/// Reads a whole number, and throws Error as read_quantity() does.
std::int64_t read_integer(const Tree& tree, const std::string& name);

/// Returns a quantity as the shortest text that gives the same bits again, for example `0.017 m`.
std::string write_quantity(double value, Unit unit);

/// Returns a constant as it is written in a config: "none" for an absent value, "" for no constant.
std::string constant_text(const FixedValue& constant, Unit unit);

/// Returns several quantities as a list.
Tree write_quantities(const double* values, std::size_t count, Unit unit);
/// Returns a table with rows of `columns` values as a list of lists.
Tree write_table(const std::vector<double>& values, std::size_t columns, Unit unit);

/// Returns "m", "s", "N", "rad", "m/s", ..., or "" for no unit.
std::string unit_symbol(Unit unit);

/// Return "length", "time", ..., and the names of the accepted units, for messages and descriptions.
std::string dimension_name(Unit unit);
std::vector<std::string> unit_names(Unit unit);

}  // namespace palpate
