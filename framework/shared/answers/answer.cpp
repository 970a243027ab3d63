// SPDX-License-Identifier: MIT
#include "answers/answer.hpp"

#include "reading/reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace palpate {
namespace {

constexpr double kBelowFloor = 0.01;      // metres
constexpr double kMostForce = 1000.0;     // newtons; a value in millinewtons is usually larger
constexpr double kMostSeconds = 86400.0;  // one day; a value in milliseconds may be larger
constexpr std::size_t kLongestLine = 200;

/// Names of the outcomes in their order, without the last, `unknown`.
constexpr const char* kOutcomes[] = {"contact", "no_contact", "unreachable", "timeout", "aborted"};

/// Returns false for NaN.
bool is_within(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace

HeightBounds height_bounds(double desk, double overrun, double hover) {
  return {desk - overrun - kBelowFloor, desk + hover, "1 cm below desk - overrun to desk + hover"};
}

std::optional<AnswerFault> find_fault(const TapResult& answer, const HeightBounds& bounds) {
  if (answer.is_contact() && !is_within(answer.height(), bounds.lowest, bounds.highest)) {
    return AnswerFault{fmt::format("height {:.6g} m is outside {:.4g} to {:.4g} m ({})", answer.height(), bounds.lowest,
                                   bounds.highest, bounds.meaning),
                       "give metres in the scene's frame (are these millimetres?)"};
  }
  if (!is_within(answer.force, 0.0, kMostForce)) {
    return AnswerFault{fmt::format("force {:.6g} N is outside 0 to {:g} N", answer.force, kMostForce),
                       "give the size of the push in newtons (are these millinewtons?)"};
  }
  if (answer.peak_force && !is_within(*answer.peak_force, 0.0, kMostForce)) {
    return AnswerFault{fmt::format("peak force {:.6g} N is outside 0 to {:g} N", *answer.peak_force, kMostForce),
                       "give the largest push in newtons (are these millinewtons?)"};
  }
  if (!is_within(answer.seconds, 0.0, kMostSeconds)) {
    return AnswerFault{fmt::format("seconds {:.6g} is outside 0 to {:.0f}", answer.seconds, kMostSeconds),
                       "give the time of the tap in seconds (are these milliseconds?)"};
  }
  return std::nullopt;
}

std::optional<Outcome> answered_outcome(const std::string& name) {
  const auto* const known = std::find(std::begin(kOutcomes), std::end(kOutcomes), name);
  if (known == std::end(kOutcomes)) return std::nullopt;
  return static_cast<Outcome>(known - std::begin(kOutcomes));
}

std::string plain_line(const std::string& text) { return one_line(text, kLongestLine); }

}  // namespace palpate
