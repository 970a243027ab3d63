// SPDX-License-Identifier: MIT
#include "answers/tap_result_checks.hpp"

#include "reading/read_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace palpate {
namespace {

constexpr double kBelowFloor = 0.01;      // metres
constexpr double kMostForce = 1000.0;     // newtons; a value in millinewtons is usually larger
constexpr double kMostSeconds = 86400.0;  // one day; a value in milliseconds may be larger
constexpr std::size_t kLongestLine = 200;

/// Names of the outcomes in the order of Outcome, without the last outcome, `unknown`.
constexpr const char* kOutcomes[] = {"contact", "no_contact", "unreachable", "timeout", "aborted"};

/// Returns whether a value is within bounds; false for NaN.
bool is_within(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace

HeightBounds height_bounds(double desk, double overrun, double hover) {
  return {desk - overrun - kBelowFloor, desk + hover, "1 cm below desk - overrun to desk + hover"};
}

void complete_contact(const TapLine& line, TapResult& answer) {
  if (answer.is_contact() && answer.distance && !answer.contact) answer.contact = line.at(*answer.distance);
  const bool is_point = answer.contact && answer.contact->allFinite();
  if (is_point && !answer.distance) answer.distance = (*answer.contact - line.start).dot(line.direction);
  if (!line.from_above) return;
  if (answer.contact) answer.contact->head<2>() = line.start.head<2>();
  answer.distance.reset();
}

std::optional<AnswerFault> find_fault(const TapResult& answer, const TapLine& line, const HeightBounds& bounds) {
  if (answer.distance && !is_within(*answer.distance, 0.0, line.length))
    return AnswerFault{fmt::format("distance {:.6g} m is outside 0 to {:.4g} m (the length of the line)",
                                   *answer.distance, line.length),
                       "give metres from the start of the line (are these millimetres?)"};
  if (answer.is_contact() && (!answer.contact || !(line.from_above || answer.distance)))
    return AnswerFault{"the contact has no position",
                       line.from_above ? "give its height" : "give the distance along the line"};
  if (!line.from_above && answer.contact && !(answer.contact->array().abs() <= kAnyArm.highest).all())
    return AnswerFault{"the position of the contact is more than 10 m away (no arm is that long)",
                       "give metres in the scene's frame (are these millimetres?)"};
  if (line.from_above && answer.is_contact() && !is_within(answer.height(), bounds.lowest, bounds.highest))
    return AnswerFault{fmt::format("height {:.6g} m is outside {:.4g} to {:.4g} m ({})", answer.height(), bounds.lowest,
                                   bounds.highest, bounds.meaning),
                       "give metres in the scene's frame (are these millimetres?)"};
  if (!is_within(answer.force, 0.0, kMostForce))
    return AnswerFault{fmt::format("force {:.6g} N is outside 0 to {:g} N", answer.force, kMostForce),
                       "give the size of the push in newtons (are these millinewtons?)"};
  if (answer.peak_force && !is_within(*answer.peak_force, 0.0, kMostForce))
    return AnswerFault{fmt::format("peak force {:.6g} N is outside 0 to {:g} N", *answer.peak_force, kMostForce),
                       "give the largest push in newtons (are these millinewtons?)"};
  if (!is_within(answer.seconds, 0.0, kMostSeconds))
    return AnswerFault{fmt::format("seconds {:.6g} is outside 0 to {:.0f}", answer.seconds, kMostSeconds),
                       "give the time of the tap in seconds (are these milliseconds?)"};
  return std::nullopt;
}

std::optional<Outcome> answered_outcome(const std::string& name) {
  const auto* const known = std::find(std::begin(kOutcomes), std::end(kOutcomes), name);
  if (known == std::end(kOutcomes)) return std::nullopt;
  return static_cast<Outcome>(known - std::begin(kOutcomes));
}

std::string plain_line(const std::string& text) { return one_line(text, kLongestLine); }

}  // namespace palpate
