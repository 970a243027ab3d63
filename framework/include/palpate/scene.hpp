// SPDX-License-Identifier: MIT
// The world as a config describes it. A simulator taps it, the metrics compare with it; a robot's backend reads only
// its area and its desk.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/shape.hpp>
#include <palpate/types.hpp>

#include <memory>
#include <vector>

namespace palpate {

/// The rectangle of the desk in which taps may fall: [0, width] x [0, depth], metres.
struct Area {
  double width = 0.0;
  double depth = 0.0;
};

/// A desk with objects on it, seen from above: one height per place. Immutable once built; safe to share. What is
/// pushed about in a run is a scene after the other: after().
class Scene {
 public:
  virtual ~Scene() = default;

  virtual Area area() const = 0;

  /// Height of the bare desk, metres.
  virtual double desk() const = 0;

  /// Height of the highest thing at (x, y), metres: the desk, or an object on it. Defined on the whole plane.
  virtual double height(double x, double y) const = 0;

  /// Whether the tool comes from any side, or else from above.
  virtual bool any_side() const = 0;

  /// Where the line first meets an object, metres from its origin, negative behind it; +infinity if it meets none. The
  /// desk does not count. z of the line is as heights are.
  virtual double first_intersection(const Line& line) const = 0;

  /// Which parts of the line lie in an object, in their order: what is solid, not what it encloses. See
  /// Shape::intervals().
  virtual std::vector<Stretch> intervals(const Line& line) const = 0;

  /// Upper bound of `height` over the plane, metres.
  virtual double highest() const = 0;

  /// How taps of this scene differ from perfect ones.
  virtual const Effects& effects() const = 0;

  /// The rule that separates object from desk, the same for robot, simulator and truth: strictly higher than the desk
  /// plus a margin that the config names (`scene.min_object_height`).
  virtual bool on_object(double height) const = 0;

  /// The scene as it stands after so many taps; null where that is this one. Does not outlive it.
  virtual std::unique_ptr<const Scene> after(int taps) const {
    static_cast<void>(taps);
    return nullptr;
  }

  /// How many objects the config puts on the desk.
  virtual int objects() const = 0;

  /// Which of them, from 0 in the order of the config, is the highest at (x, y); kNoObject where there is none.
  virtual int object(double x, double y) const = 0;
  static constexpr int kNoObject = -1;
};

}  // namespace palpate
