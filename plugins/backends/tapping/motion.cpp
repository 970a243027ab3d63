// SPDX-License-Identifier: MIT
#include "tapping/motion.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate::tapping {

namespace {

/// Returns a field with values above 0. `source` is the origin of the default.
Field positive(const char* name, const char* meaning, Unit unit, const char* source) {
  return Field(name, meaning).in(unit).above(0).from(source);
}

std::string per_second(double value) { return centimetres(value) + "/s"; }

std::string descent(const MotionOptions& motion, double desk, const TapRequest& request) {
  const Descent plan = plan_descent(motion, desk, request.predicted);
  std::string expected;
  if (plan.start < plan.hover)
    expected = fmt::format("at {} to {} above the desk, just above what is expected, and on ",
                           per_second(motion.adaptive_hover->speed), centimetres(plan.start - desk));
  const bool steps = motion.type == MotionOptions::Type::paper;
  return fmt::format("descend {}at {}{} to at most {} below the desk", expected, per_second(motion.speed),
                     steps ? " in steps of " + centimetres(motion.step) : "", centimetres(desk - plan.floor));
}

std::string contact(const MotionOptions& motion) {
  std::string first = fmt::format("stop at {} above the tare: a contact", newtons(motion.threshold));
  if (motion.type != MotionOptions::Type::two_stage) return first;
  return fmt::format("{}; then {} back and again at {} to {}", first, centimetres(motion.back_off),
                     per_second(motion.fine_speed), newtons(motion.fine_threshold));
}

/// Error of the detection time, s. The height that a moving arm measures has an error of speed * kTimeError. This is an
/// estimate for arms like Baxter's, see `latency` in configs/effects/standard.yaml.
constexpr double kTimeError = 0.015;
/// Error in metres of the height of a resting arm; see `pose_noise` in configs/effects/standard.yaml.
constexpr double kHeightError = 0.001;

class MotionList final : public Motions {
 public:
  MotionList(std::vector<MotionOptions> motions, double desk) : motions_(std::move(motions)), desk_(desk) {}

  int count() const override { return static_cast<int>(motions_.size()); }

  double seconds(const TapRequest& request, double surface) const override {
    const MotionOptions& motion = at(request.motion);
    const Descent descent = plan_descent(motion, desk_, request.predicted);
    const double met = std::min(surface, descent.hover);
    return travel_seconds(motion, request) + ideal_seconds(motion, descent, met) +
           retreat_seconds(motion, descent, met);
  }

  double deviation(int number) const override {
    const MotionOptions& motion = at(number);
    return math::hypot(kHeightError,
                       kTimeError * (motion.type == MotionOptions::Type::two_stage ? motion.fine_speed : motion.speed));
  }

 private:
  const MotionOptions& at(int number) const { return motions_[static_cast<std::size_t>(number)]; }

  std::vector<MotionOptions> motions_;
  double desk_;
};

}  // namespace

void AdaptiveHover::list(Fields& fields) {
  fields.real(deviations, Field("deviations",
                                "height of the slow descent's start above the predicted height, in standard deviations "
                                "of the predicted height")
                              .at_least(0)
                              .from("2: the surface is higher in about 2 % of the taps"));
  fields.real(clearance, positive("clearance",
                                  "distance added to the height of the slow descent's start. After a contact above the "
                                  "start, the arm also moves up by this distance",
                                  Unit::metre, "an estimate: several times the error of a good tap"));
  fields.real(speed,
              positive("speed", "speed of the fast descent from the travel height to the start of the slow descent",
                       Unit::metre_per_second,
                       "a third of travel_speed, as the arm hits a wrongly predicted surface at this speed"));
  fields.real(certainty, Field("certainty",
                               "minimum probability at which the descent relies on the footprint; not given: an object "
                               "is expected everywhere. If an object is this probable, the descent ends below the "
                               "object. If the bare desk is this probable, only the desk is expected")
                             .above(0.5)
                             .at_most(1));
}

void MotionOptions::list(Fields& fields) {
  list_types(fields, {});
  list_rest(fields);
}

void BackendMotion::list(Fields& fields) {
  list_types(
      fields,
      {{"per_tap", "motion with the highest information gain per second, chosen for each tap", [this](Fields& inner) {
          inner.sections(of, Field("of", "list of motions to choose from. Each motion has its own options"));
        }}});
  if (type != Type::per_tap) return list_rest(fields);
  fields.require(of.size() >= 2, "of", "must name at least two motions to choose from");
  const auto same = [this](const MotionOptions& one) { return one.hover == of.front().hover; };
  fields.require(std::all_of(of.begin(), of.end(), same), "of", "must all have the same hover");
}

void MotionOptions::list_types(Fields& fields, const std::vector<Case>& more) {
  const auto pause_after = [this](Fields& inner, const char* meaning) {
    inner.real(pause, Field("pause", meaning).in(Unit::second).at_least(0).from("Sun and Min 2021: 0.5 s"));
  };
  std::vector<Case> types{
      {"paper",
       "downward steps with a pause after each step, until the force rises. The height is measured after the last "
       "pause",
       [&, this](Fields& inner) {
         inner.real(step, positive("step", "length of one downward step", Unit::metre, "Sun and Min 2021: 3 cm"));
         pause_after(inner, "pause after each step");
       }},
      {"two_stage", "descent until the force rises, a short retreat, and a second descent that is slower and gentler",
       [&, this](Fields& inner) {
         inner.real(back_off, positive("back_off", "distance of the retreat between the two stages", Unit::metre,
                                       "2 cm: the joint springs relax, and a false contact is noticed"));
         pause_after(inner, "pause before the second stage. The tare is repeated during the pause");
         inner.real(fine_speed, positive("fine_speed", "speed of the second stage", Unit::metre_per_second,
                                         "2 cm/s: 5 mm of set-point ahead of the arm at a lag of 0.3 s"));
         inner.real(fine_threshold, positive("fine_threshold", "force above the tare at which the second stage ends",
                                             Unit::newton, "6 N: four deviations of 1.5 N of noise"));
       }},
      {"continuous",
       "descent at constant speed until the force rises. The measured height is the height at which the force began to "
       "rise",
       [this](Fields& inner) {
         inner.real(brake, Field("brake",
                                 "distance of the set-point above the arm after a contact. The set-point jumps to this "
                                 "height, so that a lagging arm stops sooner and presses less")
                               .in(Unit::metre)
                               .at_least(0)
                               .from("0: the set-point jumps to the arm's position"));
         inner.flag(confirm, Field("confirm",
                                   "whether a contact counts only if the force lasts for 0.1 s. This condition rules "
                                   "out jerks. Real arms always use the condition"));
       }}};
  types.insert(types.end(), more.begin(), more.end());
  fields.choice(type, Field("type", "type of the tapping motion"), types);
}

void MotionOptions::list_rest(Fields& fields) {
  fields.real(
      speed,
      positive(
          "speed",
          "speed of the descent. With `type: paper`, this is the speed of each step. With `type: two_stage`, this is "
          "the speed of the first stage",
          Unit::metre_per_second,
          "2.4 cm/s: with a lag of 0.35 s and 1500 N/m the paper's motion then has its known 13 mm and 6.4 s per tap"));
  fields.real(threshold, positive("threshold", "force above the tare at which a contact is detected", Unit::newton,
                                  "10 N: used with Baxter, whose firmware stops the arm at 16 N"));
  fields.real(
      hover,
      positive("hover", "height above the desk of the arm's travel between taps. Each descent begins at this height",
               Unit::metre, "13.5 cm: 2.5 cm above the highest of the paper's objects"));
  fields.section(adaptive_hover, Field("adaptive_hover",
                                       "fast descent to just above the predicted surface, followed by the slow "
                                       "descent; not given: the slow descent starts at `hover`"));
  fields.real(travel_speed, positive("travel_speed", "speed of the tool at travel height", Unit::metre_per_second,
                                     "30 cm/s: Baxter's default speed ratio is 0.3 of about 1 m/s"));
  fields.real(retreat_speed,
              positive("retreat_speed", "speed of the tool on its way up", Unit::metre_per_second, "as travel_speed"));
  fields.real(
      tare,
      Field("tare",
            "duration of the rest before the descent. The mean force during the rest becomes the zero of the force")
          .in(Unit::second)
          .at_least(0)
          .from("20 samples at Baxter's 100 Hz: 1.5 N of noise become 0.3 N"));
  fields.real(overrun, Field("overrun", "depth below the desk. A descent without contact ends at this depth")
                           .in(Unit::metre)
                           .at_least(0)
                           .from("3 cm: 1500 N/m reach 10 N after 0.7 cm, and a lag adds 1 cm"));
  fields.real(timeout, positive("timeout", "duration after which a tap fails", Unit::second,
                                "ten times the duration of the paper's motion")
                           .at_most(3600));
  fields.real(force_limit, Field("force_limit",
                                 "maximum force of a tap; not given: no limit. At three quarters of this force the arm "
                                 "stops, even if no contact is detected")
                               .in(Unit::newton)
                               .above(0)
                               .from("16 N: where Baxter's firmware stops the arm"));
}

QuantitySet predicts(const BackendMotion& motion) {
  const MotionOptions& alone = motion;
  return motion.of.empty() ? predicts(alone)
                           : QuantitySet{quantity::kHeightMean, quantity::kHeightStd, quantity::kObjectProbability};
}

QuantitySet predicts(const MotionOptions& motion) {
  if (!motion.adaptive_hover) return {};
  QuantitySet out{quantity::kHeightMean, quantity::kHeightStd};
  if (motion.adaptive_hover->certainty) out.insert(quantity::kObjectProbability);
  return out;
}

Descent plan_descent(const MotionOptions& motion, double desk, const std::optional<Prediction>& predicted) {
  Descent out{desk + motion.hover, desk + motion.hover, desk - motion.overrun};
  if (motion.adaptive_hover && predicted) {
    const AdaptiveHover& adaptive = *motion.adaptive_hover;
    const double probability = adaptive.certainty ? predicted->probability.value_or(0.5) : 0.5;
    const double certainty = adaptive.certainty.value_or(1.0);
    // The surface is never below the desk, whatever the models predict.
    double surface = desk;
    if (probability > 1.0 - certainty)
      surface = std::max(desk, predicted->height + adaptive.deviations * predicted->standard_deviation);
    out.start = std::min(out.hover, surface + adaptive.clearance);
    // If a contact is not detected, the arm presses down to the floor. The floor is therefore equally far below an
    // object as below the bare desk.
    if (probability >= certainty) {
      constexpr double kSure = 3.0;  // standard deviations
      const double lowest = predicted->height - kSure * predicted->standard_deviation;
      out.floor = std::min(out.start, std::max(desk, lowest) - motion.overrun);
    }
  }
  return out;
}

double travel_seconds(const MotionOptions& motion, const TapRequest& request) {
  if (!request.previous) return 0.0;
  const Eigen::Vector3d& here = request.line.start;
  const Eigen::Vector3d& before = request.previous->start;
  return math::hypot(here.x() - before.x(), here.y() - before.y()) / motion.travel_speed;
}

double retreat_seconds(const MotionOptions& motion, const Descent& descent, double height) {
  return std::max(0.0, descent.hover - height) / motion.retreat_speed;
}

double ideal_seconds(const MotionOptions& motion, const Descent& descent, double surface) {
  double seconds = motion.tare;
  double from = descent.hover;
  if (descent.start < descent.hover) {
    const AdaptiveHover& adaptive = *motion.adaptive_hover;
    const double end = std::max(descent.start, surface);
    seconds += (descent.hover - end) / adaptive.speed;
    from = end;
    if (surface > descent.start) {  // contact during the fast descent: the arm backs off, then descends as usual
      from = std::min(descent.hover, end + adaptive.clearance);
      seconds += (from - end) / adaptive.speed;
    }
  }
  const double down = from - surface;
  seconds += down / motion.speed;
  switch (motion.type) {
    case MotionOptions::Type::paper:
      // Whole steps are counted, because the pause also follows a step that a contact cuts short.
      return seconds + std::max(1.0, std::ceil(down / motion.step)) * motion.pause;
    case MotionOptions::Type::two_stage: {
      const double back = std::min(motion.back_off, descent.hover - surface);
      return seconds + back / motion.speed + motion.pause + back / motion.fine_speed;
    }
    case MotionOptions::Type::continuous:
    case MotionOptions::Type::per_tap:
      return seconds + kWatched;
  }
  return seconds;
}

std::unique_ptr<Motions> motions(const BackendMotion& motion, double desk) {
  return motion.of.empty() ? nullptr : std::make_unique<MotionList>(motion.of, desk);
}

std::string centimetres(double length) { return fmt::format("{:.1f} cm", 100.0 * length); }
std::string newtons(double force) { return fmt::format("{:.1f} N", force); }
std::string place(const Target& target) {
  return fmt::format("({:.1f}, {:.1f}) cm", 100.0 * target.x, 100.0 * target.y);
}

std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from) {
  return {fmt::format("travel {}to {} at {} above the desk, {}", from ? "from " + place(*from) + " " : "",
                      place(request.line.target()), centimetres(motion.hover), per_second(motion.travel_speed)),
          descent(motion, desk, request), contact(motion)};
}

}  // namespace palpate::tapping
