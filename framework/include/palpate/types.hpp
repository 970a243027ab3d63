// SPDX-License-Identifier: MIT
// The words of the domain that every plugin shares: points, taps and what a tap brings back.
// All quantities are SI: metres, seconds, newtons, radians.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace palpate {

/// n points on the desk, one a row: x, y in metres, in the frame of the area (origin at its lower left corner).
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Views that cross the plugin boundary: the caller owns and sizes them, the callee never resizes.
using PointsView = Eigen::Ref<const Points>;
using VectorView = Eigen::Ref<const Eigen::VectorXd>;
using VectorOut = Eigen::Ref<Eigen::VectorXd>;
using MatrixOut = Eigen::Ref<Eigen::MatrixXd>;

/// Where the next tap goes, in metres within the area.
struct Target {
  double x = 0.0;
  double y = 0.0;
};

/// A straight line without ends: the points origin + x * direction for every real x.
struct Line {
  Eigen::Vector3d origin;     ///< metres
  Eigen::Vector3d direction;  ///< of unit length
};

/// How far along a line that goes down it is at a height; infinity for one that is level or goes up.
inline double distance_down_to(double height, const Line& line) {
  const double down = line.direction.z();
  return down < 0.0 ? (height - line.origin.z()) / down : std::numeric_limits<double>::infinity();
}

/// The way of a tool towards what it is to touch: from the origin of the line, `length` metres along its direction, its
/// shaft straight behind it. In the frame of the area, z as heights are. A tap from above is the one straight down.
struct Approach {
  Line line;
  double length = 0.0;
};

/// A contact as the models see it.
struct Touch {
  Target place;
  double height = 0.0;  ///< above the desk, metres
  bool on = false;      ///< on an object, by the scene's rule (`min_object_height`)
};

/// Some outlines, drawn as probably as they are believed in, over M places: of each place, a column, which of them hold
/// it. Outline k is bit k % 64 of row k / 64.
struct OutlineSample {
  int count = 0;  ///< a multiple of 64; 0 where nothing is believed of whole outlines
  Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic> holds;
  /// What a tap at a place is expected to find, apart from all that was touched so far: its extent, square metres.
  Eigen::VectorXd to_find;
};

/// What became of one tap. Only `contact` reaches the models; all others are recorded and leave the belief as it was.
enum class Outcome {
  contact,      ///< the tool touched something; the height is valid
  no_contact,   ///< the descent ended at its floor without a touch
  unreachable,  ///< the place cannot be reached; nothing moved, or the arm turned back
  timeout,      ///< the motion did not end in its time
  aborted,      ///< stopped by the user or by a safety rule
  unknown,      ///< the program died between moving and recording; found by `resume`
};

/// The answer of a backend to one tap.
struct Contact {
  Outcome outcome = Outcome::unknown;
  double height =
      0.0;             ///< of the touched point, metres, in the frame of `Scene::desk()`; meaningful only for `contact`
  double force = 0.0;  ///< at contact, newtons; meaningful only for `contact`
  double seconds = 0.0;  ///< robot time that the tap took, whatever its outcome
  std::string reason;    ///< why a tap failed or the run ends, one line; else empty
  /// No other tap can be made until somebody has seen to the robot. The tap is recorded like any other, then the run
  /// fails with `reason`; `palpate resume --retry-failed` goes on after it.
  bool ends_run = false;
  /// The largest force against the tool in all of the tap, newtons, of failed taps, too: the true one where a simulator
  /// knows it, else the largest that was felt. None where no force is simulated or felt.
  std::optional<double> peak = std::nullopt;
  /// Of a tap along an approach, how far along it the tool was when it touched, metres; the height is that of the tip
  /// there. Of one that met nothing, how far it went.
  std::optional<double> along = std::nullopt;
};

}  // namespace palpate
