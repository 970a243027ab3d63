// SPDX-License-Identifier: MIT
// The touches so far, as currently interpreted: how far the tool moved before it met a surface, and whether this was
// the surface of the desk. Later contacts with the desk improve the estimate of the overtravel. This changes the
// readings of earlier touches.
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
  /// `desk`: height of the desk, metres; `tip`: radius of the tool's round tip, metres. Contacts more than `most` above
  /// the desk are never with the desk.
  TouchLog(double desk, double tip, double most) : desk_(desk), overtravel_(tip, most) {}

  /// Takes the rays of a camera, before the first tap. `shows_object`: whether any ray of the whole view ends on an
  /// object.
  void look(std::vector<SurfaceTouch> seen, bool shows_object);

  /// Returns the current reading of a result. Returns nullopt if the result contains no information: for a failed tap,
  /// and for a tap without a contact that ends far below the desk. Such a tap did not feel the desk, so it may not have
  /// felt an object either.
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const;

  /// Adds the result of a tap, and reads all contacts again.
  void add(const TapRequest& request, const TapResult& result);

  /// Returns the current readings of all touches, with heights relative to the desk. The touches of the view come
  /// first.
  const std::vector<SurfaceTouch>& touches() const { return touches_; }
  std::size_t seen() const { return seen_; }
  const TapsSoFar& taps() const { return taps_; }
  /// Returns whether a camera saw an object before the first tap.
  bool is_object_seen() const { return is_object_seen_; }

  /// Returns whether touches were read again, or their spread changed, since the last call.
  bool take_changes() { return std::exchange(has_changed_, false); }
  const Overtravel& overtravel() const { return overtravel_; }

 private:
  struct ReportedTouch {
    SurfaceTouch touch;  ///< touch as the arm reported it
    double force;
    int tap;
  };
  std::optional<ReportedTouch> reported(const TapRequest& request, const TapResult& result) const;
  TapReading reading(const SurfaceTouch& touch, int tap) const;

  double desk_;
  Overtravel overtravel_;
  std::vector<ReportedTouch> reported_;
  std::vector<SurfaceTouch> touches_;
  std::size_t seen_ = 0;
  bool is_object_seen_ = false;
  TapsSoFar taps_;
  bool has_changed_ = false;
};

}  // namespace palpate
