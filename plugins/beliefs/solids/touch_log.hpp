// SPDX-License-Identifier: MIT
// The touches so far, as currently read: how far the tool moved before it met the surface, and whether that was the
// desk. Later contacts with the desk improve the estimate of the overtravel, and so change the readings of earlier
// ones.
#pragma once

#include "solids/overtravel.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/belief.hpp>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace palpate {

class TouchLog {
 public:
  /// `desk`: its height, metres; `tip`: radius of the tool's round tip, metres. Contacts more than `most` above the
  /// desk are never with the desk.
  TouchLog(double desk, double tip, double most) : desk_(desk), overtravel_(tip, most) {}

  /// Takes the rays of a camera, before the first tap. `shows_object`: whether one of all its rays ends on an object.
  void look(std::vector<SurfaceTouch> seen, bool shows_object);

  /// Returns how a result is read now; nullopt if it teaches nothing: of a failed tap, and of one that felt nothing of
  /// the desk, and so would have felt nothing of an object.
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const;

  /// Adds the result of a tap, and reads all contacts again.
  void add(const TapRequest& request, const TapResult& result);

  /// Returns the current readings of all touches, lengths relative to the desk. The touches of the view come first.
  const std::vector<SurfaceTouch>& touches() const { return touches_; }
  std::size_t seen() const { return seen_; }
  const TapsSoFar& taps() const { return taps_; }
  /// Whether a camera saw an object before the first tap.
  bool is_object_seen() const { return is_object_seen_; }

  /// Returns whether touches were read again, or their spread changed, since the last call.
  bool take_changes() { return std::exchange(has_changed_, false); }
  const Overtravel& overtravel() const { return overtravel_; }

 private:
  struct Reported {
    SurfaceTouch touch;  ///< touch as the arm reported it
    double force;
    int tap;
  };
  std::optional<Reported> reported(const TapRequest& request, const TapResult& result) const;
  TapReading reading(const SurfaceTouch& touch, int tap) const;

  double desk_;
  Overtravel overtravel_;
  std::vector<Reported> reported_;
  std::vector<SurfaceTouch> touches_;
  std::size_t seen_ = 0;
  bool is_object_seen_ = false;
  TapsSoFar taps_;
  bool has_changed_ = false;
};

}  // namespace palpate
