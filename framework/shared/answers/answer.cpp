// SPDX-License-Identifier: MIT
#include "answers/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace palpate {
namespace {

constexpr double kBelowFloor = 0.01;      // metres
constexpr double kMostForce = 1000.0;     // newtons: a tenth of a ton; millinewtons of a tap are beyond it
constexpr double kMostSeconds = 86400.0;  // a day; milliseconds of a tap may be beyond it
constexpr std::size_t kLongestLine = 200;

/// In the order of Outcome, without the last, `unknown`.
constexpr const char* kOutcomes[] = {"contact", "no_contact", "unreachable", "timeout", "aborted"};

/// Not a number lies within nothing.
bool is_within(double value, double least, double most) { return value >= least && value <= most; }

/// One character of UTF-8, and how many bytes it takes. A byte that begins no character stands for itself.
struct Character {
  std::uint32_t code;
  std::size_t bytes;
};
Character character_at(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t bytes = first < 0xc0 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  std::uint32_t code = bytes == 1 ? first : first & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (at + i >= text.size() || (byte(at + i) & 0xc0) != 0x80) return {first, 1};
    code = code << 6 | (byte(at + i) & 0x3fU);
  }
  return {code, bytes};
}

/// Controls (C0, DEL, C1), line and paragraph separators, and Unicode's Bidi_Control (UAX 9).
bool is_unprintable(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

HeightBounds height_bounds(double desk, double overrun, double hover) {
  return {desk - overrun - kBelowFloor, desk + hover, "1 cm below desk - overrun to desk + hover"};
}

std::optional<AnswerFault> find_fault(const Contact& answer, const HeightBounds& bounds) {
  if (answer.outcome == Outcome::contact && !is_within(answer.height, bounds.lowest, bounds.highest)) {
    return AnswerFault{fmt::format("height {:.6g} m is outside {:.4g} to {:.4g} m ({})", answer.height, bounds.lowest,
                                   bounds.highest, bounds.meaning),
                       "give metres in the scene's frame (are these millimetres?)"};
  }
  if (!is_within(answer.force, 0.0, kMostForce)) {
    return AnswerFault{fmt::format("force {:.6g} N is outside 0 to {:g} N", answer.force, kMostForce),
                       "give the size of the push in newtons (are these millinewtons?)"};
  }
  if (answer.peak && !is_within(*answer.peak, 0.0, kMostForce)) {
    return AnswerFault{fmt::format("peak force {:.6g} N is outside 0 to {:g} N", *answer.peak, kMostForce),
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

std::string plain_line(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const Character one = character_at(text, i);
    if (out.size() >= kLongestLine) return out + "...";
    out += is_unprintable(one.code) ? " " : text.substr(i, one.bytes);
    i += one.bytes;
  }
  return out;
}

}  // namespace palpate
