// SPDX-License-Identifier: MIT
// The touches so far, as currently read: how far the tool moved before it met the surface, and whether that was the
// desk. Later contacts with the desk improve the estimate of the overtravel, and so change the readings of earlier
// ones.
#pragma once

#include "solids/overtravel.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/tap.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

class TouchLog {
 public:
  /// `desk`: its height, metres; `tip`: radius of the tool's round tip, metres. Contacts more than `most` above the
  /// desk are never with the desk.
  TouchLog(double desk, double tip, double most) : desk_(desk), overtravel_(tip, most) {}

  /// Adds the rays of a camera, before the first tap.
  void look(const std::vector<SurfaceTouch>& seen);

  /// Returns the current reading of a result; nullopt if it has no information. That is so for a failed tap, and for a
  /// tap that passed the desk without a contact, because it would not have felt an object either.
  std::optional<SurfaceTouch> read(const TapRequest& request, const TapResult& result) const;

  /// Adds the result of a tap, and reads all contacts again.
  void add(const TapRequest& request, const TapResult& result);

  /// Returns the current readings of all touches, lengths relative to the desk. The touches of the view come first.
  const std::vector<SurfaceTouch>& touches() const { return touches_; }
  std::size_t seen() const { return seen_; }
  /// Returns the readings of the taps; the view is left out.
  std::vector<TapReading> readings() const;

  /// Returns whether readings or their spread have changed since set_unchanged().
  bool has_changed() const { return has_changed_; }
  void set_unchanged() { has_changed_ = false; }
  const Overtravel& overtravel() const { return overtravel_; }

 private:
  struct Reported {
    SurfaceTouch touch;  ///< touch as the arm reported it
    double force;
    int tap;
  };
  std::optional<Reported> reported(const TapRequest& request, const TapResult& result) const;

  double desk_;
  Overtravel overtravel_;
  std::vector<Reported> reported_;
  std::vector<SurfaceTouch> touches_;
  std::size_t seen_ = 0;
  bool has_changed_ = false;
};

}  // namespace palpate
