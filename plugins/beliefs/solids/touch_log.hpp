// SPDX-License-Identifier: MIT
// The touches so far, as they are read now: how far the tool came before it met the surface, and whether that was the
// desk. Later contacts with the desk show how deep contacts are reported, and change how earlier ones are read.
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
  /// `desk`: its height, metres; `tip`: radius of the tool's round tip, metres; no contact higher than `most` above the
  /// desk is with the desk.
  TouchLog(double desk, double tip, double most) : desk_(desk), overtravel_(tip, most) {}

  /// Takes the rays of a camera, before the first tap. `shows_object`: whether one of all its rays ends on an object.
  void look(std::vector<SurfaceTouch> seen, bool shows_object);

  /// Returns how a result is read now; nullopt if it teaches nothing: of a failed tap, and of one that felt nothing of
  /// the desk, and so would have felt nothing of an object.
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const;

  /// Takes the result of a tap. All contacts so far are read again.
  void add(const TapRequest& request, const TapResult& result);

  /// Touches as they are read now, lengths relative to the desk: first those that were seen.
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
    SurfaceTouch touch;  ///< as the arm reported it
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
