// SPDX-License-Identifier: MIT
// The scene of a config. Simulators tap this scene, and errors of a reconstruction are computed against it. The backend
// of a robot reads only the area and the desk.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/shape.hpp>
#include <palpate/types.hpp>

#include <memory>
#include <vector>

namespace palpate {

/// Rectangle of the desk for taps: [0, width] x [0, depth], metres.
struct Area {
  double width = 0.0;
  double depth = 0.0;
};

/// A desk with objects. Immutable and safe to share between threads. If objects are pushed during a run, after()
/// returns the later scenes.
class Scene {
 public:
  virtual ~Scene() = default;

  virtual Area area() const = 0;

  /// Returns the height of the bare desk, metres.
  virtual double desk() const = 0;

  /// Returns the largest height at (x, y), metres: the height of the desk, or of the highest object. Defined on the
  /// whole plane.
  virtual double height(double x, double y) const = 0;

  /// Returns `scene.min_object_height` of the config, metres.
  virtual double min_object_height() const = 0;

  /// Returns the distance of the first intersection of the line with an object, metres from the line's origin, negative
  /// behind the origin; +infinity without an intersection. The desk does not count. z is in the frame of the heights.
  virtual double first_intersection(const Line& line) const = 0;

  /// Returns the intervals of the line inside of objects, in ascending order. Hollow space does not count. See
  /// Shape::intervals().
  virtual std::vector<LineInterval> intervals(const Line& line) const = 0;

  /// Returns an upper bound of `height` over the plane, metres.
  virtual double highest() const = 0;

  /// Returns the effects that make taps in this scene imperfect.
  virtual const Effects& effects() const = 0;

  /// Returns whether a height is on an object: strictly higher than the desk plus min_object_height(). The rule
  /// is the same for robot, simulator and truth.
  virtual bool on_object(double height) const = 0;

  /// Returns the scene after this many taps, or null if it has not changed. The result must not outlive this scene.
  virtual std::unique_ptr<const Scene> after(int /*taps*/) const { return nullptr; }

  /// Returns the number of objects.
  virtual int objects() const = 0;

  /// Returns the index of the highest object at (x, y), in the order of the config; kNoObject without an object.
  virtual int object(double x, double y) const = 0;
  static constexpr int kNoObject = -1;
};

}  // namespace palpate
