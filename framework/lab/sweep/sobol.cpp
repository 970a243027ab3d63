// SPDX-License-Identifier: MIT
#include "sweep/sobol.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>
#include <boost/random/sobol.hpp>

#include <charconv>
#include <cmath>

namespace palpate {
namespace {

constexpr const char* kHowToDraw = "write uniform(0.1 mm, 1 mm) or log(1cm, 10cm), both ends with the same unit";
constexpr std::int64_t kMaxSamples = 100'000;
constexpr std::size_t kMaxKeys = 1000;  // Boost's tables end at 3667

/// A continuous range.
struct Range {
  bool logarithmic;
  double first;
  double last;
  std::string unit;

  /// `share` in [0, 1).
  double at(double share) const {
    return logarithmic ? first * std::pow(last / first, share) : first + share * (last - first);
  }
};

Range parse_range(const Tree::Entry& entry) {
  const Tree& value = entry.value;
  const auto refuse = [&](const std::string& reason, const char* hint) {
    throw Error(value.place.text(), entry.key + ": " + reason, hint);
  };
  const std::string shown = value.is_scalar() ? "'" + value.text + "'" : "this";
  const std::optional<Call> call = parse_call(value, entry.key, {"uniform", "log"}, kHowToDraw);
  if (!call || call->bounds.size() != 2) refuse(shown + " is no continuous range", kHowToDraw);
  Range range{call->name == "log", call->bounds[0].value, call->bounds[1].value, call->bounds[0].unit};
  if (call->bounds[1].unit != range.unit) refuse("the ends of " + shown + " have unlike units", kHowToDraw);
  if (!(range.first < range.last) || (range.logarithmic && !(range.first > 0.0)) ||
      !std::isfinite(range.last - range.first)) {
    refuse(shown + " is no range", range.logarithmic ? "both ends must be above 0, the first below the last"
                                                     : "the first end must lie below the last");
  }
  return range;
}

/// Nine digits are more than any setting needs, and still tell points apart.
double shortened(double value) {
  const std::string text = fmt::format("{:.9g}", value);
  double out = value;
  std::from_chars(text.data(), text.data() + text.size(), out);  // of every locale
  return out;
}

std::int64_t read_samples(const Tree& described, const Place& place) {
  const Tree* samples = described.find("samples");
  if (samples == nullptr) throw Error(place.text(), "sweep.sobol: 'samples' is missing", "write samples: 64");
  const std::int64_t count = read_integer(*samples, "sweep.sobol.samples");
  if (count < 1 || count > kMaxSamples) {
    throw Error(samples->place.text(), fmt::format("sweep.sobol.samples: {} is out of range", count),
                fmt::format("it must be 1 to {}", kMaxSamples));
  }
  return count;
}

}  // namespace

std::vector<Axis> sobol_axes(const Tree& described, ValueCount& count) {
  if (!described.is_map()) {
    throw Error(described.place.text(), "sweep.sobol: expects samples and keys",
                "write sobol: {samples: 64, keys: {kernel.length_scale: \"log(1cm, 10cm)\"}}");
  }
  for (const Tree::Entry& entry : described.entries) {
    if (entry.key != "samples" && entry.key != "keys") {
      throw Error(entry.place.text(), fmt::format("unknown option '{}' of sweep.sobol", entry.key),
                  suggestion(entry.key, {"samples", "keys"}));
    }
  }
  const std::int64_t samples = read_samples(described, described.place);
  const Tree* keys = described.find("keys");
  if (keys == nullptr || !keys->is_map() || keys->entries.empty() || keys->entries.size() > kMaxKeys) {
    throw Error((keys != nullptr ? keys->place : described.place).text(),
                "sweep.sobol.keys: expects a map of 1 to 1000 keys to ranges",
                "write keys: {kernel.length_scale: \"log(1cm, 10cm)\"}");
  }
  count.add(keys->entries.size() * static_cast<std::size_t>(samples), keys->place, "sweep.sobol");
  std::vector<Axis> axes;
  std::vector<Range> ranges;
  // As for the first taps: one random pattern of bits an axis, added without carry to every point, keeps the points
  // as evenly spread and moves the first of them off the corner of all lower ends.
  std::vector<std::uint64_t> shift;
  Random random(0, "sweep.sobol");
  for (const Tree::Entry& entry : keys->entries) {
    axes.push_back({entry.key, {}, entry.value});
    ranges.push_back(parse_range(entry));
    shift.push_back(random.bits());
  }
  boost::random::sobol sequence(axes.size());
  std::vector<std::uint64_t> point(axes.size(), 0);  // Boost's sequence leaves out the origin, with which it begins
  for (std::int64_t i = 0; i < samples; ++i) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const double share = static_cast<double>((point[k] ^ shift[k]) >> 11) * 0x1.0p-53;
      axes[k].values.push_back(number(shortened(ranges[k].at(share)), ranges[k].unit, axes[k].written));
    }
    for (std::uint64_t& coordinate : point) coordinate = sequence();
  }
  return axes;
}

}  // namespace palpate
