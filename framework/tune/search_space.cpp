// SPDX-License-Identifier: MIT
#include "tune/search_space.hpp"

#include "sweep/sobol.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr std::size_t kMostSettings = 10'000;
constexpr double kRedraw = 0.1;  ///< probability of a new value of a list

}  // namespace

SearchSpace::SearchSpace(const std::vector<TunedKey>& keys, std::vector<bool> is_whole)
    : keys_(keys), is_whole_(std::move(is_whole)) {
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    const auto& range = keys_[key].range;
    if (!range || !is_whole_[key]) continue;
    if (std::ceil(range->first) <= std::floor(range->last)) continue;
    throw Error(keys_[key].written.place.text(),
                fmt::format("{}: '{}' has no whole number", keys_[key].key, keys_[key].written.text),
                "write for example uniform(10, 60)");
  }
}

bool SearchSpace::is_finite() const {
  return std::none_of(keys_.begin(), keys_.end(), [](const TunedKey& one) { return one.range.has_value(); });
}

std::vector<Point> SearchSpace::grid() const {
  std::vector<Point> out{{}};
  for (const TunedKey& key : keys_) {
    if (out.size() * key.values.size() > kMostSettings)
      throw Error(key.written.place.text(), fmt::format("{}: there are more than 10000 settings", key.key),
                  "use fewer values, or a continuous range");
    std::vector<Point> longer;
    for (const Point& point : out) {
      for (std::size_t value = 0; value < key.values.size(); ++value) {
        longer.push_back(point);
        longer.back().push_back(static_cast<double>(value));
      }
    }
    out = std::move(longer);
  }
  return out;
}

std::vector<Point> SearchSpace::sobol(std::size_t count) const {
  std::vector<Point> points = sobol_points(count, keys_.size(), "tune");
  for (Point& point : points) {
    for (std::size_t key = 0; key < keys_.size(); ++key) {
      if (!keys_[key].range) point[key] = std::floor(point[key] * static_cast<double>(keys_[key].values.size()));
    }
  }
  return points;
}

Point SearchSpace::near(const Point& parent, double spread, Random& random) const {
  constexpr double kScales[] = {0.5, 1.0, 2.0};
  Point out = parent;
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    if (keys_[key].range) {
      const double scale = kScales[random.index(3)];
      out[key] = std::clamp(parent[key] + spread * scale * random.normal(), 0.0, 1.0);
    } else if (random.uniform() < kRedraw) {
      out[key] = static_cast<double>(random.index(keys_[key].values.size()));
    }
  }
  return out;
}

Tree SearchSpace::value(std::size_t key, double coordinate) const {
  const TunedKey& tuned = keys_[key];
  if (!tuned.range) return tuned.values[static_cast<std::size_t>(coordinate)];
  // Finer differences of a setting do not matter, and with six digits tables remain readable.
  double value = rounded(tuned.range->at(coordinate), 6);
  if (is_whole_[key])
    value = std::clamp(std::round(tuned.range->at(coordinate)), std::ceil(tuned.range->first),
                       std::floor(tuned.range->last));
  return number(value, tuned.range->unit, tuned.written);
}

std::optional<double> SearchSpace::coordinate(std::size_t key, const std::string& text) const {
  const auto& range = keys_[key].range;
  const std::optional<double> position = keys_[key].position(text);
  if (!range || !position) return position;
  const double value = std::clamp(*position, range->first, range->last);
  const double share = range->logarithmic ? math::log(value / range->first) / math::log(range->last / range->first)
                                          : (value - range->first) / (range->last - range->first);
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace palpate
