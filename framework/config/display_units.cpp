// SPDX-License-Identifier: MIT
#include "config/display_units.hpp"

#include "config/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Numbers with a unit that are smaller than this bound (in SI units) are shown as 0, because they are rounding errors
/// of coordinates.
constexpr double kReadsAsZero = 1e-9;

bool reads_as_zero(const std::string& text) { return text.find_first_of("123456789") == std::string::npos; }

/// Returns how many decimals `value` needs for `digits` significant digits; negative for large values.
int decimals_for(double value, int digits) {
  return digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
}

/// Returns the unit for numbers up to `largest` (in SI).
DisplayScale unit_for(Unit unit, double largest, LengthKind kind) {
  if (unit == Unit::metre) {
    const bool nothing = largest < kReadsAsZero;
    if (largest >= (kind == LengthKind::error ? 1.0 : 10.0)) return {"m", 1.0};
    if (!nothing && largest < 1e-5) return {"um", 1e-6};
    if (kind == LengthKind::error || (!nothing && largest < 1e-3)) return {"mm", 1e-3};
    return {"cm", 1e-2};
  }
  if (unit == Unit::second && largest < 1.0 && largest >= kReadsAsZero)
    return largest < 1e-3 ? DisplayScale{"us", 1e-6} : DisplayScale{"ms", 1e-3};
  return {unit_symbol(unit), 1.0};
}

}  // namespace

std::string DisplayScale::number(double value) const {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  const double shown = (!unit.empty() && std::abs(value) < kReadsAsZero) || value == 0.0 ? 0.0 : value / factor;
  if (scientific && shown != 0.0) return fmt::format("{:.{}e}", shown, decimals);
  const int places = scientific ? 0 : decimals;
  const bool is_small =
      open ? std::abs(shown) < std::pow(10.0, 1 - places) : std::abs(shown) < 0.5 * std::pow(10.0, -places);
  if (shown == 0.0 || !is_small) return fmt::format("{:.{}f}", shown, places);
  constexpr int kMostDecimals = 9;
  const int needed = std::max(places, decimals_for(shown, 2));
  return needed > kMostDecimals ? fmt::format("{:.1e}", shown) : fmt::format("{:.{}f}", shown, needed);
}

std::string DisplayScale::difference(double value) const {
  if (scientific) return (value > 0.0 ? "+" : "") + number(value);
  const std::string text = fmt::format("{:+.{}f}", value / factor, decimals);
  return reads_as_zero(text) && std::isfinite(value) ? text.substr(1) : text;
}

DisplayScale readable_scale(Unit unit, const std::vector<double>& values, int digits, LengthKind kind) {
  double largest = 0.0;
  double least = 0.0;
  for (const double value : values) {
    const double size = std::abs(value);
    if (size == 0.0 || !std::isfinite(size)) continue;
    largest = std::max(largest, size);
    least = least == 0.0 ? size : std::min(least, size);
  }
  DisplayScale scale = unit_for(unit, largest, kind);
  if (!(least > 0.0)) return scale;
  constexpr int kMostDecimals = 4;
  constexpr double kMostPlain = 1e10;
  if (decimals_for(largest / scale.factor, digits) > digits + kMostDecimals || largest / scale.factor >= kMostPlain) {
    scale.scientific = scale.unit.empty() || largest >= kReadsAsZero;
    scale.decimals = scale.scientific ? digits - 1 : 0;
    return scale;
  }
  const int most = std::max(kMostDecimals, decimals_for(largest / scale.factor, digits));
  scale.decimals = std::clamp(decimals_for(least / scale.factor, digits), 0, most);
  return scale;
}

DisplayScale usual_scale(Unit unit, LengthKind kind) {
  DisplayScale scale = unit_for(unit, 0.0, kind);
  scale.decimals = unit == Unit::metre && kind == LengthKind::place ? 2 : 1;
  scale.open = unit == Unit::metre;
  return scale;
}

std::string readable(double value, Unit unit, int digits, LengthKind kind) {
  DisplayScale scale = unit_for(unit, std::abs(value), kind);
  if (scale.unit == "cm" &&
      std::abs(value) >= kReadsAsZero) {  // a single position has the unit that gives a short number
    if (std::abs(value) < 0.00995) scale = {"mm", 1e-3};
    if (std::abs(value) >= 1.0) scale = {"m", 1.0};
  }
  const bool is_zero = !scale.unit.empty() && std::abs(value) < kReadsAsZero;
  return scale.with_unit(significant(is_zero ? 0.0 : value / scale.factor, digits));
}

std::string significant(double value, int digits) {
  if (value == 0.0) return "0";
  if (!std::isfinite(value)) return fmt::format("{}", value);
  // %g uses an exponent for numbers with more whole digits than significant digits. 1234 is easier to read than
  // 1.23e+03.
  const int decimals = decimals_for(value, digits);
  if (decimals < 0 && std::abs(value) < 1e6) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace palpate
