// SPDX-License-Identifier: MIT
#include "config/quantity.hpp"

#include "config/catch_error.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace palpate {
namespace {

/// A unit and its factor to the SI unit. The factor is a power of ten if possible, because a change of the exponent in
/// the text is exact.
struct UnitName {
  std::string_view name;
  Unit unit;
  int power;            ///< power of ten of the factor
  double factor = 1.0;  ///< rest of the factor
};

constexpr double kPi = 3.14159265358979323846;
constexpr std::array kUnits{
    UnitName{"m", Unit::metre, 0},
    UnitName{"dm", Unit::metre, -1},
    UnitName{"cm", Unit::metre, -2},
    UnitName{"mm", Unit::metre, -3},
    UnitName{"um", Unit::metre, -6},
    UnitName{"s", Unit::second, 0},
    UnitName{"ms", Unit::second, -3},
    UnitName{"us", Unit::second, -6},
    UnitName{"min", Unit::second, 0, 60.0},
    UnitName{"h", Unit::second, 0, 3600.0},
    UnitName{"N", Unit::newton, 0},
    UnitName{"mN", Unit::newton, -3},
    UnitName{"kN", Unit::newton, 3},
    UnitName{"rad", Unit::radian, 0},
    UnitName{"mrad", Unit::radian, -3},
    UnitName{"deg", Unit::radian, 0, kPi / 180.0},
    UnitName{"m/s", Unit::metre_per_second, 0},
    UnitName{"cm/s", Unit::metre_per_second, -2},
    UnitName{"mm/s", Unit::metre_per_second, -3},
    UnitName{"mm/min", Unit::metre_per_second, -3, 1.0 / 60.0},
    UnitName{"N/m", Unit::newton_per_metre, 0},
    UnitName{"N/cm", Unit::newton_per_metre, 2},
    UnitName{"kN/m", Unit::newton_per_metre, 3},
    UnitName{"N/mm", Unit::newton_per_metre, 3},
};

/// Returns whether `text` is a continuous range: see config/expand.hpp.
bool is_continuous_range(std::string_view text) {
  for (const std::string_view name : {"uniform(", "log_uniform("}) {
    if (text.substr(0, name.size()) == name) return true;
  }
  return false;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool looks_octal(std::string_view number) {
  if (!number.empty() && (number[0] == '-' || number[0] == '+')) number.remove_prefix(1);
  return number.size() > 1 && number[0] == '0' && is_digit(number[1]);
}

struct Dimension {
  const char* name;
  const char* example;
};

/// Names in the order of Unit.
constexpr std::array kDimensions{
    Dimension{"number", "a plain number"},
    Dimension{"length", "a length like '1.7 cm'"},
    Dimension{"time", "a time like '500 ms'"},
    Dimension{"force", "a force like '10 N'"},
    Dimension{"angle", "an angle like '30 deg'"},
    Dimension{"speed", "a speed like '10 cm/s'"},
    Dimension{"stiffness", "a stiffness like '1500 N/m'"},
};

const Dimension& dimension_of(Unit unit) { return kDimensions[static_cast<std::size_t>(unit)]; }

[[noreturn]] void refuse(const Tree& tree, const std::string& name, const std::string& reason,
                         const std::string& hint) {
  throw Error(tree.place.text(), fmt::format("{}: {}", name, reason), hint);
}

[[noreturn]] void refuse(const Tree& tree, const std::string& name, const std::string& reason, Unit unit) {
  refuse(tree, name, reason, fmt::format("write {}", dimension_of(unit).example));
}

/// Splits a scalar into number and unit. Throws Error if it does not begin with a decimal number.
std::pair<std::string_view, std::string_view> split(const Tree& tree, const std::string& name, Unit unit) {
  if (tree.kind == Tree::Kind::null) refuse(tree, name, "has no value", unit);
  if (!tree.is_scalar()) refuse(tree, name, "is a list or a map, not a number", unit);
  const std::string_view text = tree.text;
  const std::size_t length = decimal_length(text);
  if (length == 0 && is_continuous_range(text))
    refuse(tree, name, fmt::format("'{}' is not a number", text),
           "use ranges only in scene.objects.draw.of and in the keys of sweep.sobol");
  if (length == 0) refuse(tree, name, fmt::format("'{}' is not a number", text), unit);
  std::string_view rest = text.substr(length);
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
  const std::string_view number = text.substr(0, length);
  if (looks_octal(number))
    refuse(tree, name, fmt::format("'{}' has a leading zero", text),
           "octal numbers are not supported: write it without the zero");
  return {number, rest};
}

double to_double(std::string_view number, int power, const Tree& tree, const std::string& name, Unit unit) {
  // from_chars accepts no leading '+'. A power of ten is applied to the exponent in the text, which is exact.
  if (number[0] == '+') number.remove_prefix(1);
  std::string text(number);
  if (power != 0) {
    const auto e = text.find_first_of("eE");
    int exponent = 0;
    if (e != std::string::npos) {
      const char* first = text.data() + e + 1 + (text[e + 1] == '+' ? 1 : 0);
      if (std::from_chars(first, text.data() + text.size(), exponent).ec != std::errc() || std::abs(exponent) > 9999)
        refuse(tree, name, fmt::format("'{}' is out of range", tree.text), unit);
      text.erase(e);
    }
    text += fmt::format("e{}", exponent + power);
  }
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || !std::isfinite(value))
    refuse(tree, name, fmt::format("'{}' is out of range", tree.text), unit);
  return value;
}

}  // namespace

std::size_t decimal_length(std::string_view text) {
  const std::size_t sign = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  // from_chars would also accept a second sign and infinity.
  if (sign == text.size() || (!is_digit(text[sign]) && text[sign] != '.')) return 0;
  double value = 0.0;
  const auto read = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  return read.ec == std::errc::invalid_argument ? 0 : static_cast<std::size_t>(read.ptr - text.data());
}

std::string unit_symbol(Unit unit) {
  for (const UnitName& known : kUnits) {
    if (known.unit == unit && known.power == 0 && known.factor == 1.0) return std::string(known.name);
  }
  return {};
}

std::string dimension_name(Unit unit) { return dimension_of(unit).name; }

std::vector<std::string> unit_names(Unit unit) {
  std::vector<std::string> names;
  for (const UnitName& known : kUnits) {
    if (known.unit == unit) names.emplace_back(known.name);
  }
  return names;
}

double read_quantity(const Tree& tree, const std::string& name, Unit unit) {
  const auto [number, symbol] = split(tree, name, unit);
  if (!symbol.empty() && symbol[0] == ',')
    refuse(tree, name, fmt::format("'{}' has a decimal comma", tree.text), "write a point");
  if (unit == Unit::none) {
    if (!symbol.empty())
      refuse(tree, name, fmt::format("'{}' is not a plain number", tree.text), "write it without a unit");
    return to_double(number, 0, tree, name, unit);
  }
  if (symbol.empty()) refuse(tree, name, fmt::format("'{}' has no unit", tree.text), unit);
  for (const UnitName& known : kUnits) {
    if (known.name != symbol) continue;
    if (known.unit != unit)
      refuse(tree, name,
             fmt::format("'{}' is a {}, not a {}", tree.text, dimension_name(known.unit), dimension_name(unit)), unit);
    return to_double(number, known.power, tree, name, unit) * known.factor;
  }
  refuse(tree, name, fmt::format("unknown unit '{}'", symbol), suggestion(symbol, unit_names(unit)));
}

std::optional<AnyQuantity> any_quantity(const std::string& text) {
  const std::size_t length = decimal_length(text);
  if (length == 0) return std::nullopt;
  const auto symbol = text.find_first_not_of(" \t", length);
  Unit unit = Unit::none;
  if (symbol != std::string::npos) {
    const auto known = std::find_if(kUnits.begin(), kUnits.end(), [&](const UnitName& one) {
      return one.name == std::string_view(text).substr(symbol);
    });
    if (known == kUnits.end()) return std::nullopt;
    unit = known->unit;
  }
  std::optional<AnyQuantity> out;
  // A value such as 1e999 m is not an error here; the function returns nullopt.
  catch_error([&] { out = AnyQuantity{read_quantity(Tree::scalar(text), "", unit), unit}; });
  return out;
}

std::int64_t read_integer(const Tree& tree, const std::string& name) {
  const auto [number, rest] = split(tree, name, Unit::none);
  std::int64_t value = 0;
  const char* first = number.data() + (number[0] == '+' ? 1 : 0);
  const char* last = number.data() + number.size();
  const auto result = std::from_chars(first, last, value);
  if (result.ec == std::errc::result_out_of_range)
    refuse(tree, name, fmt::format("'{}' is out of range", tree.text), "at most 9223372036854775807");
  if (result.ec != std::errc() || result.ptr != last || !rest.empty())
    refuse(tree, name, fmt::format("'{}' is not a whole number", tree.text), "write digits only");
  return value;
}

std::string write_quantity(double value, Unit unit) {
  // Quantities are always written in SI units, so no factor is needed.
  const std::string number = fmt::format("{}", value);
  const std::string symbol = unit_symbol(unit);
  return symbol.empty() ? number : number + " " + symbol;
}

std::string constant_text(const FixedValue& constant, Unit unit) {
  switch (constant.kind) {
    case FixedValue::Kind::none:
      return "";
    case FixedValue::Kind::absent:
      return "none";
    case FixedValue::Kind::real:
      return write_quantity(constant.real, unit);
    case FixedValue::Kind::integer:
      return std::to_string(constant.integer);
    case FixedValue::Kind::flag:
      return constant.flag ? "true" : "false";
    case FixedValue::Kind::text:
      return constant.text;
  }
  return "";
}

Tree write_quantities(const double* values, std::size_t count, Unit unit) {
  Tree list = Tree::list();
  for (std::size_t i = 0; i < count; ++i) list.items.push_back(Tree::scalar(write_quantity(values[i], unit)));
  return list;
}

Tree write_table(const std::vector<double>& values, std::size_t columns, Unit unit) {
  Tree rows = Tree::list();
  for (std::size_t i = 0; i < values.size(); i += columns)
    rows.items.push_back(write_quantities(&values[i], columns, unit));
  return rows;
}

}  // namespace palpate
