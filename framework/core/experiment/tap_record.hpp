// SPDX-License-Identifier: MIT
// What one tap leaves behind, and what a whole run does.
#pragma once

#include "experiment/forecast.hpp"
#include "experiment/metrics.hpp"
#include "experiment/object_errors.hpp"
#include "experiment/phases.hpp"
#include "experiment/tap_belief.hpp"
#include "regular/regular_factor.hpp"

#include <palpate/backend.hpp>
#include <palpate/footprint.hpp>
#include <palpate/types.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Who chose a tap.
enum class Source { initial, acquisition, fallback, caller };

/// How the reason of a fallback begins where scores from outside were at fault.
constexpr const char* kOfCaller = "of the caller's scores: ";

/// A process as it stood when a tap was chosen.
struct GpState {
  std::vector<KernelParameter> kernel;
  GpSettings settings;
  double log_marginal_likelihood = 0.0;
  double jitter = 0.0;
  double condition = 1.0;
  std::string engine;             ///< that keeps the maps
  std::string engine_reason;      ///< why that one, one line
  double error_bound = 0.0;       ///< of what the engine adds to the rounding of dense: see EngineState::error_bound
  std::optional<FitSummary> fit;  ///< the fit after the latest of its taps; absent if none was due then
};

/// A footprint as it stood when a tap was chosen, where it is not the weight.
struct FootprintState {
  std::vector<FootprintNumber> numbers;
  std::string remark;
};

/// All models as they stood, as far as the loop had built them, and how good they were.
struct ModelState {
  std::optional<GpState> height_gp, label_gp;
  std::optional<GpState> surface_gp;  ///< of `surface: two_part`
  std::optional<FootprintState> footprint;
  std::optional<Forecast> forecast;                                 ///< where a stop rule asks for it
  std::optional<double> expected_rmse;                              ///< metres; of a tap for observers alone: see Watch
  std::optional<std::vector<SuspectedOutlier>> suspected_outliers;  ///< where contacts may lie
  Errors errors;
};

/// A tap that was made, as far as what comes after depends on it.
struct PastTap {
  Target target;
  Contact contact;
  Source source = Source::initial;
  int motion = 0;                                      ///< of the backend's, where it has several
  std::optional<Prediction> predicted = std::nullopt;  ///< of the height at the target, for a backend that wants it
  std::string why{};                                   ///< of a fallback
  std::optional<Approach> approach = std::nullopt;     ///< the way of the tool; none: straight down at the target
  std::string
      unreached{};  ///< with it, which of the lines that were drawn the backend refused: SpaceBelief::unreached()

  /// Whether it came along an approach all of whose way was free, which tells as much as a contact.
  bool is_without_contact() const { return approach && contact.outcome == Outcome::no_contact; }

  /// Whether scores from outside were asked for, and not the strategy.
  bool of_caller() const {
    return source == Source::caller || (source == Source::fallback && why.rfind(kOfCaller, 0) == 0);
  }
};

/// One tap: the choice, the state it was made from, and what came of it. Everything about the models is absent where
/// the loop had not built them.
struct TapRecord : PastTap, ModelState {
  int number = 1;
  int candidate = 0;

  // At the choice.
  std::optional<double> score, uncertainty, weight, exploration;
  std::optional<double> probability;  ///< where the footprint is not the weight
  std::optional<int> ties;
  std::optional<Target> runner_up;
  std::optional<double> runner_up_score;
  std::optional<double> expected_seconds;  ///< where there are several motions
  std::optional<double> max_standard_deviation, mean_standard_deviation, min_weight, max_weight;

  // After the tap.
  std::optional<double> corrected;     ///< height less what is thought to be added to all; absent where none is learnt
  std::optional<bool> on_object;       ///< as it is read when it is made; absent unless the outcome is a contact
  std::optional<bool> true_on_object;  ///< absent where no truth is known
};

/// The reason to stop of a run whose user wanted it: it has no summary, and can be carried on.
constexpr const char* kStoppedByUser = "interrupted";

/// The reasons of a tap that failed because its height is none, or because it ended where the tool never was.
constexpr const char* kHeightRefused = "the backend reported a height that is not a finite number";
constexpr const char* kAlongRefused = "the backend reported an end point that is not on the path of the tool";
constexpr const char* kNumberRefused = "the backend reported a force or a time that is not a finite number";
/// Whether a tap failed for one of these.
inline bool is_refused(const Contact& contact) {
  return contact.reason == kHeightRefused || contact.reason == kAlongRefused || contact.reason == kNumberRefused;
}

/// The contacts with an object: those at a cell of it, whatever was made of them.
struct ObjectTouches {
  int taps = 0;
  std::optional<int> first_tap;
};

/// What became of one object in a run.
struct ObjectResult : ObjectErrors, ObjectTouches {};

/// The result of a run, in the order of summary.json but for what the record adds (clocks, memory, names).
struct RunResult : ModelState {
  /// Counts a tap, but for what a contact of it touched, which whoever believes it knows.
  void count(const PastTap& tap) {
    ++taps;
    robot_seconds += tap.contact.seconds;
    if (tap.source == Source::fallback) ++diagnostics["fallback"];
    if (is_refused(tap.contact)) ++diagnostics["heights_rejected"];
    if (tap.contact.outcome != Outcome::contact) ++(tap.is_without_contact() ? no_contact_taps : failed_taps);
  }

  /// Adds what rounding made necessary in the factorisations of one model; jitter in the square of its unit. Models are
  /// of the same taps: one that several set aside is one.
  void count(const FactorReport& factors) {
    jitter_max = std::max(jitter_max, factors.jitter);
    diagnostics["jitter"] += factors.raised;
    diagnostics["pivoted"] += factors.pivoted;
    int& redundant_taps = diagnostics["redundant_taps"];
    redundant_taps = std::max(redundant_taps, factors.redundant_taps);
  }

  std::string stop_reason;
  bool interrupted = false;
  int taps = 0;
  int object_taps = 0;
  int desk_taps = 0;
  int no_contact_taps = 0;  ///< from any side: those that met nothing
  int failed_taps = 0;
  std::optional<int> first_hit_tap;
  std::vector<Relabelled> relabelled;  ///< contacts that the counts above take otherwise than their TapRecord does
  Calibration calibration;
  std::optional<std::vector<ObjectResult>> objects;  ///< of the scene, in its order; absent where no truth is known
  double robot_seconds = 0.0;
  double jitter_max = 0.0;
  /// By kind, zeros included.
  std::map<std::string, int> diagnostics{{"fallback", 0}, {"fit_failed", 0},     {"heights_rejected", 0}, {"jitter", 0},
                                         {"pivoted", 0},  {"redundant_taps", 0}, {"variance_clamped", 0}};
};

/// What is known of a tap before it is made, for people.
struct Preview {
  std::optional<Prediction> expected;  ///< of the height, where the models are there already
  std::vector<std::string> motion;     ///< what the backend says that it would do, in lines
};

/// A model and who reads it: "label GP" and "acquisition weighted".
struct ModelReader {
  std::string model;
  std::string who;
};

/// Learns of every tap, in time.
class Journal {
 public:
  virtual ~Journal() = default;
  /// The tap is chosen; nothing has moved and nothing is announced. If it may not be made, the run ends there,
  /// interrupted.
  virtual bool permits(const TapRecord& /*tap*/) { return true; }
  /// Whether it shows the errors of the state that a tap is chosen from, which are then computed, whoever reads them.
  virtual bool wants_errors() const { return true; }
  /// The tap is chosen; nothing has moved.
  virtual void announce(const TapRecord& tap) = 0;
  /// The tap is over. `seconds` is the time since the last tap, by phase.
  virtual void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) = 0;
};

}  // namespace palpate
