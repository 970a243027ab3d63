// SPDX-License-Identifier: MIT
// The record of one tap and of a whole run, and the observers of a run.
#pragma once

#include <palpate/phase_clock.hpp>

#include <palpate/backend.hpp>
#include <palpate/belief.hpp>
#include <palpate/reconstruction_errors.hpp>
#include <palpate/record_fields.hpp>
#include <palpate/tap.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Beginning of a fallback's reason, if the scores of a calling program made the fallback necessary.
constexpr const char* kOfCaller = "of the caller's scores: ";

/// One tap: the request, its choice, the state of the models before the tap, and the result.
struct TapRecord {
  TapRequest request;
  TapResult result;
  /// Reading of the result by the belief at the time of the tap; nullopt for a failed tap.
  std::optional<TapReading> reading;

  // The choice.
  int candidate = 0;
  std::string why{};  ///< reason of a fallback
  std::optional<double> score;
  std::optional<int> ties;
  std::optional<Target> runner_up;
  std::optional<double> runner_up_score;
  std::optional<double> expected_seconds;  ///< expected duration; only with several motions
  /// Drawn lines that the backend rejected, in order: one hexadecimal digit per four lines, with the highest bit for
  /// the first line. Digits after the last rejected line are left out.
  std::string unreached{};

  BeliefState state;                   ///< state before the tap
  Errors errors;                       ///< errors of the belief in that state
  std::optional<bool> true_on_object;  ///< whether the line ends on an object; nullopt if the truth is not known
  std::optional<double> shown_expected_rmse = std::nullopt;  ///< metres, as displayed before the tap

  int number() const { return request.number; }
  Target target() const { return request.line.target(); }
  bool is_contact() const { return result.is_contact(); }
  /// Returns whether the whole line was free, which is as informative as a contact.
  bool is_free_line() const { return !request.line.from_above && result.outcome == Outcome::no_contact; }
  /// Returns whether the scores of a calling program chose the tap instead of the strategy.
  bool is_of_caller() const {
    return request.source == Source::caller || (request.source == Source::fallback && why.rfind(kOfCaller, 0) == 0);
  }
};

/// Replacement for the strategy's choice: the scores of a calling program, one per candidate, or a recorded choice.
struct TapOverride {
  Eigen::VectorXd scores;           ///< finite; empty if there is a `choice`
  std::optional<TapRecord> choice;  ///< has line, source, `why` and all fields of the score
};

/// Stop reason of a run that its user interrupted. Such a run has no summary and can be resumed.
constexpr const char* kStoppedByUser = "interrupted";

/// Reasons that are recorded for a failed tap if the backend returned an impossible result.
constexpr const char* kHeightRefused = "the backend reported a height that is not a finite number";
constexpr const char* kAlongRefused = "the backend reported an end point that is not on the path of the tool";
constexpr const char* kNumberRefused = "the backend reported a force or a time that is not a finite number";
inline bool is_refused(const TapResult& result) {
  return result.reason == kHeightRefused || result.reason == kAlongRefused || result.reason == kNumberRefused;
}

/// A contact whose label has changed since its tap.
struct RelabelledContact {
  int tap = 0;
  bool on_object = false;  ///< current label
};

/// Statistics of the contacts whose positions are on one object of the true scene, whatever labels the contacts have.
struct ObjectTouches {
  int taps = 0;
  std::optional<int> first_tap;
};

/// One object of the scene at the end of a run.
struct ObjectResult : ObjectErrors, ObjectTouches {};

/// The result of a run.
struct RunResult {
  std::string stop_reason;
  bool interrupted = false;
  bool from_above = true;  ///< whether all candidate lines point straight down
  int taps = 0;
  int object_taps = 0;
  int desk_taps = 0;
  int no_contact_taps = 0;  ///< only for lines that are not from above
  int failed_taps = 0;
  std::optional<int> first_hit_tap;
  std::vector<RelabelledContact> relabelled;
  std::optional<std::vector<ObjectResult>> objects;  ///< in the order of the scene; nullopt if the truth is not known
  double robot_seconds = 0.0;
  BeliefState state;
  Errors errors;
};

/// Prediction for a tap before it is made, for display.
struct Preview {
  std::optional<Prediction> expected;  ///< predicted height, if the height models are fitted
  std::vector<std::string> motion;     ///< lines of text from the backend
};

class Experiment;

/// Observes the taps of a run.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Returns whether the tap may be made. At this time nothing has moved and no tap was announced. If not, the run is
  /// interrupted, as if the tap had never been chosen.
  virtual bool permits(const TapRecord& /*tap*/, const Experiment& /*experiment*/) { return true; }
  /// Returns whether the observer shows the errors before each tap, even if no reader of the run needs them.
  virtual bool wants_errors() const { return false; }
  /// Called when the tap is chosen and nothing has moved yet.
  virtual void announce(const TapRecord& /*tap*/) {}
  /// Called after the tap. `seconds`: time since the previous tap, by phase.
  virtual void record(const TapRecord& /*tap*/, const std::array<double, kPhases>& /*seconds*/) {}
};

}  // namespace palpate
