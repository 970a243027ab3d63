// SPDX-License-Identifier: MIT
#include "tapping/words.hpp"

#include <fmt/format.h>

namespace palpate::tapping {
namespace {

std::string speed(double value) { return centimetres(value) + "/s"; }

std::string descent(const MotionOptions& motion, double desk, const TapRequest& request) {
  const Descent plan = plan_descent(motion, desk, request.predicted);
  std::string expected;
  if (plan.start < plan.hover) {
    expected = fmt::format("at {} to {} above the desk, just above what is expected, and on ",
                           speed(motion.adaptive_hover->speed), centimetres(plan.start - desk));
  }
  const bool steps = motion.type == MotionOptions::Type::paper;
  return fmt::format("descend {}at {}{} to at most {} below the desk", expected, speed(motion.speed),
                     steps ? " in steps of " + centimetres(motion.step) : "", centimetres(desk - plan.floor));
}

std::string touch(const MotionOptions& motion) {
  const std::string first = fmt::format("stop at {} above the tare: a contact", newtons(motion.threshold));
  if (motion.type != MotionOptions::Type::two_stage) return first;
  return fmt::format("{}; then {} back and again at {} to {}", first, centimetres(motion.back_off),
                     speed(motion.fine_speed), newtons(motion.fine_threshold));
}

}  // namespace

std::string centimetres(double length) { return fmt::format("{:.1f} cm", 100.0 * length); }
std::string newtons(double force) { return fmt::format("{:.1f} N", force); }
std::string place(const Target& target) {
  return fmt::format("({:.1f}, {:.1f}) cm", 100.0 * target.x, 100.0 * target.y);
}

std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from) {
  return {fmt::format("travel {}to {} at {} above the desk, {}", from ? "from " + place(*from) + " " : "",
                      place(request.target), centimetres(motion.hover), speed(motion.travel_speed)),
          descent(motion, desk, request), touch(motion)};
}

}  // namespace palpate::tapping
