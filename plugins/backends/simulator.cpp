// SPDX-License-Identifier: MIT
// A simulated arm over the scene of the config. It models what the scene requires and nothing else: without effects
// the contact stops the motion exactly at the surface, and a step costs time, not accuracy.
#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <chrono>
#include <cmath>
#include <thread>

namespace palpate::backends {

/// How the arm comes down.
struct MotionOptions : Options {
  enum class Type { paper };
  Type type = Type::paper;
  double step = 0.03;
  double pause = 0.5;

  void list(Fields& fields) override {
    fields.choice(
        type, Field("type", "how the arm comes down"),
        {{"paper", "in steps with a pause after each, until the force rises", [this](Fields& inner) {
            inner.real(step,
                       Field("step", "height of one step").in(Unit::metre).above(0).from("Sun and Min 2021: 3 cm"));
            inner.real(
                pause,
                Field("pause", "rest after each step").in(Unit::second).at_least(0).from("Sun and Min 2021: 0.5 s"));
          }}});
  }
};

struct SimulatorOptions : Options {
  MotionOptions motion;
  double hover = 0.15;
  double speed = 0.1;
  double threshold = 8.0;
  double pace = 0.0;

  void list(Fields& fields) override {
    fields.section(motion, Field("motion", "the tapping motion"));
    fields.real(hover, Field("hover", "height above the desk at which the arm travels and the descent begins")
                           .in(Unit::metre)
                           .above(0)
                           .from("clear of the paper's highest object, 11 cm"));
    fields.real(speed, Field("speed", "of the tool while it travels, steps and retreats")
                           .in(Unit::metre_per_second)
                           .above(0)
                           .from("a cautious speed for a collaborative arm, an estimate"));
    fields.real(threshold, Field("threshold", "force at which a contact is declared; it is what a contact reports")
                               .in(Unit::newton)
                               .above(0)
                               .from("5 to 10 N above tare, below the 16 N at which Baxter's firmware stops"));
    fields.real(
        pace,
        Field("pace", "seconds of real time spent per second of robot time; 0 runs as fast as it can").at_least(0));
  }
};

class Simulator final : public Backend {
 public:
  using Options = SimulatorOptions;

  Simulator(const Options& options, const Context& context)
      : options_(options),
        scene_(context.scene),
        interrupted_(context.interrupted),
        hover_(scene_.desk() + options.hover) {
    if (scene_.highest() >= hover_) {
      throw Error("hover", "an object is as high as the arm travels, or higher", "raise it or lower the object");
    }
  }

  Contact tap(const TapRequest& request) override {
    const Target& target = request.target;
    const double surface = scene_.height(target.x, target.y);
    const Target from = request.previous.value_or(target);
    const double travel = std::hypot(target.x - from.x, target.y - from.y);
    // Whole steps are counted, though contact cuts the last one short: the pause follows all the same.
    const double steps = std::ceil((hover_ - surface) / options_.motion.step);
    const double down_and_up = 2.0 * (hover_ - surface);
    const double seconds = (travel + down_and_up) / options_.speed + steps * options_.motion.pause;
    if (!wait(seconds * options_.pace)) return {Outcome::aborted, 0.0, 0.0, seconds, "interrupted"};
    return {Outcome::contact, surface, options_.threshold, seconds, {}};
  }

  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }

 private:
  /// Lets real time pass in small portions; false when the user wants to stop.
  bool wait(double seconds) const {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    while (seconds > 0.0 && Clock::now() < end) {
      if (interrupted_ != nullptr && interrupted_->load()) return false;
      std::this_thread::sleep_for(std::min<Clock::duration>(end - Clock::now(), std::chrono::milliseconds(10)));
    }
    return true;
  }

  SimulatorOptions options_;
  const Scene& scene_;
  const std::atomic<bool>* interrupted_;
  double hover_;  ///< in the frame of the scene
};

PALPATE_PLUGIN(Backend, Simulator, "simulator", "a simulated arm over the scene of the config")

}  // namespace palpate::backends
