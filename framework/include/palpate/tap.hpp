// SPDX-License-Identifier: MIT
// One tap: the line of the tool, the request to the backend, and the result. SI units, in the frame of the scene: x and
// y from the lower left corner of the area, heights with the same zero as Scene::desk().
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The path of the tip of the tool: from `start`, at most `length` metres along `direction`. The shaft is parallel to
/// the path, behind the tip.
struct TapLine {
  Eigen::Vector3d start{0.0, 0.0, 0.0};
  Eigen::Vector3d direction{0.0, 0.0, -1.0};  ///< unit vector
  double length = 0.0;
  /// Whether the line points straight down to the topmost surface. The arm may then enter the line at any height above
  /// the expected contact.
  bool from_above = false;

  Eigen::Vector3d at(double distance) const { return start + distance * direction; }
  Target target() const { return {start.x(), start.y()}; }
  Line line() const { return {start, direction}; }
};

/// Returns the line straight down at `target` from the height `top`, `length` metres long.
inline TapLine line_from_above(const Target& target, double top = 0.0, double length = 0.0) {
  return {{target.x, target.y, top}, {0.0, 0.0, -1.0}, length, true};
}

/// Origin of the choice of a tap: the initial design, the acquisition's scores, the fallback if these scores are all
/// equal or none is positive, or the scores of a calling program.
enum class Source { initial, acquisition, fallback, caller };

/// Prediction of the models at the end of a line: mean and standard deviation of the height, metres. With `surface:
/// two_part`, the height is that of an object, even if there is probably no object.
struct Prediction {
  double height = 0.0;
  double standard_deviation = 0.0;
  std::optional<double> probability = std::nullopt;  ///< probability of an object, for a backend that reads it
};

/// Request for one tap. The result of a simulated tap depends only on the request, the options and the seed, so a
/// resumed run continues exactly like an uninterrupted run.
struct TapRequest {
  int number = 1;  ///< number of the tap within the run, from 1
  TapLine line;
  Source source = Source::initial;
  int motion = 0;                       ///< index of the backend's motion, see motions.hpp
  double height_noise = 0.0;            ///< standard deviation that this motion adds to the height, metres
  std::optional<TapLine> previous;      ///< line of the previous tap; nullopt for the first tap
  std::optional<Prediction> predicted;  ///< only for a backend that reads predictions
  double elapsed = 0.0;                 ///< robot time of all previous taps, seconds
};

/// Outcome of one tap. The models learn from `contact` and, on lines that are not from above, from `no_contact`; other
/// outcomes are only recorded.
enum class Outcome {
  contact,      ///< the tool touched something
  no_contact,   ///< the motion reached the end of the line without a contact
  unreachable,  ///< the line cannot be reached; nothing moved, or the arm turned back
  timeout,      ///< the motion took too long
  aborted,      ///< stopped by the user or by a safety rule
  unknown,      ///< the program ended between motion and record; found by `resume`
};

/// The result of one tap.
struct TapResult {
  Outcome outcome = Outcome::unknown;
  /// Distance that the tool moved along the line until it touched something or stopped, metres, in [0, length]. May be
  /// absent on lines from above and after `no_contact`; if it is absent after `no_contact`, the tool moved the whole
  /// length.
  std::optional<double> distance = std::nullopt;
  std::optional<Eigen::Vector3d> contact = std::nullopt;  ///< the touched point, metres; only for `contact`
  double force = 0.0;                                     ///< force at contact, newtons; only for `contact`
  std::optional<double> peak_force = std::nullopt;  ///< largest force of the tap, newtons, also of a failed tap; the
                                                    ///< true force from a simulator, else the measured one
  double seconds = 0.0;                             ///< robot time of the tap, for any outcome
  std::string reason{};                             ///< why the tap failed or the run ends, one line; else empty
  /// Whether a person must check the robot before another tap. The tap is recorded, then the run fails with `reason`;
  /// `palpate resume --retry-failed` continues after it.
  bool ends_run = false;

  bool is_contact() const { return outcome == Outcome::contact; }
  /// Height of the contact, metres; 0 without one.
  double height() const { return contact ? contact->z() : 0.0; }
};

/// Returns the result of a contact on a line from above.
inline TapResult contact_on(const TapLine& line, double height, double force, double seconds) {
  TapResult out;
  out.outcome = Outcome::contact;
  out.contact.emplace(line.start.x(), line.start.y(), height);
  out.force = force;
  out.seconds = seconds;
  return out;
}

/// Returns the result of a tap without a contact.
inline TapResult tap_without_contact(Outcome outcome, double seconds, std::string reason = {}, bool ends_run = false) {
  TapResult out;
  out.outcome = outcome;
  out.seconds = seconds;
  out.reason = std::move(reason);
  out.ends_run = ends_run;
  return out;
}

/// Current reading of a result by the belief; later taps may change everything but `tap`.
struct TapReading {
  int tap = 1;
  Eigen::Vector3d position{0.0, 0.0, 0.0};  ///< position of the contact, or of the end of a line without one; metres
  bool is_contact = true;
  bool on_object = false;     ///< a contact with an object, not with the desk
  bool is_corrected = false;  ///< the position is corrected for the offset of the arm
  bool moved = false;         ///< the object was pushed later, so the reading is no longer valid at this position
  double outlier_probability = 0.0;      ///< probability that the height or the label is wrong
  double wrong_label_probability = 0.0;  ///< probability that the label is wrong; part of `outlier_probability`
};

}  // namespace palpate
