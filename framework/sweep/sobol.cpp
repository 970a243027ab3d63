// SPDX-License-Identifier: MIT
#include "sweep/sobol.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>
#include <boost/random/sobol.hpp>

namespace palpate {
namespace {

constexpr std::int64_t kMaxSamples = 100'000;
constexpr std::size_t kMaxKeys = 1000;  // Boost's tables end at dimension 3667

ContinuousRange parse_range(const Tree::Entry& entry) {
  if (const auto range = parse_continuous(entry.value, entry.key)) return *range;
  const std::string shown = entry.value.is_scalar() ? "'" + entry.value.text + "'" : "this";
  throw Error(entry.value.place.text(), entry.key + ": " + shown + " is not a continuous range", kContinuousHint);
}

std::int64_t read_samples(const Tree& described, const SourceLocation& place) {
  const Tree* samples = described.find("samples");
  if (samples == nullptr) throw Error(place.text(), "sweep.sobol: 'samples' is missing", "write samples: 64");
  const std::int64_t count = read_integer(*samples, "sweep.sobol.samples");
  if (count < 1 || count > kMaxSamples)
    throw Error(samples->place.text(), fmt::format("sweep.sobol.samples: {} is out of range", count),
                fmt::format("it must be 1 to {}", kMaxSamples));
  return count;
}

}  // namespace

std::vector<std::vector<double>> sobol_points(std::size_t count, std::size_t dimensions, std::string_view purpose) {
  // A digital shift combines all points with one random bit pattern per axis by XOR, as for the initial taps. The
  // shifted points are still evenly spread, and the first point is no longer at the lower end of every range.
  std::vector<std::uint64_t> shift;
  Random random(0, purpose);
  for (std::size_t k = 0; k < dimensions; ++k) shift.push_back(random.bits());
  boost::random::sobol sequence(dimensions);
  std::vector<std::uint64_t> bits(dimensions);  // the origin is the first point, which Boost omits
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double>& point = out.emplace_back();
    for (std::size_t k = 0; k < dimensions; ++k)
      point.push_back(static_cast<double>((bits[k] ^ shift[k]) >> 11) * 0x1.0p-53);
    for (std::uint64_t& coordinate : bits) coordinate = sequence();
  }
  return out;
}

std::vector<SweepAxis> sobol_axes(const Tree& described, ValueCount& count) {
  if (!described.is_map())
    throw Error(described.place.text(), "sweep.sobol: expects samples and keys",
                "write sobol: {samples: 64, keys: {kernel.length_scale: \"log_uniform(1 cm, 10 cm)\"}}");
  for (const Tree::Entry& entry : described.entries) {
    if (entry.key != "samples" && entry.key != "keys")
      throw Error(entry.place.text(), fmt::format("unknown option '{}' of sweep.sobol", entry.key),
                  suggestion(entry.key, {"samples", "keys"}));
  }
  const std::int64_t samples = read_samples(described, described.place);
  const Tree* keys = described.find("keys");
  if (keys == nullptr || !keys->is_map() || keys->entries.empty() || keys->entries.size() > kMaxKeys)
    throw Error((keys != nullptr ? keys->place : described.place).text(),
                "sweep.sobol.keys: expects a map of 1 to 1000 keys to ranges",
                "write keys: {kernel.length_scale: \"log_uniform(1 cm, 10 cm)\"}");
  count.add(keys->entries.size() * static_cast<std::size_t>(samples), keys->place, "sweep.sobol");
  std::vector<SweepAxis> axes;
  std::vector<ContinuousRange> ranges;
  for (const Tree::Entry& entry : keys->entries) {
    axes.push_back({entry.key, {}, entry.value});
    ranges.push_back(parse_range(entry));
  }
  for (const std::vector<double>& point : sobol_points(static_cast<std::size_t>(samples), axes.size(), "sweep.sobol")) {
    for (std::size_t k = 0; k < axes.size(); ++k)  // nine digits still distinguish all points
      axes[k].values.push_back(number(rounded(ranges[k].at(point[k]), 9), ranges[k].unit, axes[k].written));
  }
  return axes;
}

}  // namespace palpate
