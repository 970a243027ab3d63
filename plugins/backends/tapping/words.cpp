// SPDX-License-Identifier: MIT
#include "tapping/words.hpp"

#include <sstream>

namespace palpate::tapping {
namespace {

std::string rounded(double value) {
  std::ostringstream out;
  out.precision(1);
  out << std::fixed << value;
  return out.str();
}

std::string speed(double value) { return centimetres(value) + "/s"; }

std::string descent(const MotionOptions& motion, double desk, const TapRequest& request) {
  const Descent plan = plan_descent(motion, desk, request.predicted);
  std::string out = "descend ";
  if (plan.start < plan.hover) {
    out += "at " + speed(motion.adaptive_hover->speed) + " to " + centimetres(plan.start - desk) +
           " above the desk, just above what is expected, and on ";
  }
  out += "at " + speed(motion.speed);
  if (motion.type == MotionOptions::Type::paper) out += " in steps of " + centimetres(motion.step);
  return out + " to at most " + centimetres(desk - plan.floor) + " below the desk";
}

std::string touch(const MotionOptions& motion) {
  std::string out = "stop at " + newtons(motion.threshold) + " above the tare: a contact";
  if (motion.type == MotionOptions::Type::two_stage) {
    out += "; then " + centimetres(motion.back_off) + " back and again at " + speed(motion.fine_speed) + " to " +
           newtons(motion.fine_threshold);
  }
  return out;
}

}  // namespace

std::string centimetres(double length) { return rounded(100.0 * length) + " cm"; }
std::string newtons(double force) { return rounded(force) + " N"; }
std::string place(const Target& target) {
  return "(" + rounded(100.0 * target.x) + ", " + rounded(100.0 * target.y) + ") cm";
}

std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from) {
  return {"travel " + (from ? "from " + place(*from) + " " : std::string()) + "to " + place(request.target) + " at " +
              centimetres(motion.hover) + " above the desk, " + speed(motion.travel_speed),
          descent(motion, desk, request), touch(motion)};
}

}  // namespace palpate::tapping
