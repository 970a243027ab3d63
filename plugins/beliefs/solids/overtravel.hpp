// SPDX-License-Identifier: MIT
// Estimates how far a tool travels past a surface before its contact is reported. It learns this from contacts with the
// desk, whose height is known, and classifies which contacts are with the desk.
//
// The touched surface yields under the force, and an arm that lags behind its set-point or detects a contact late moves
// further. So a contact is reported too deep by a + b * F, where F is its force. OffsetModel (gp/offset_model.hpp)
// learns a and b as its offset and drift, with force in the place of time. The estimate is at least 0, because a tool
// cannot stop before the surface. If contacts with the desk are reported on the desk, nothing is changed.
//
// The spread is the random part of the overtravel: the standard deviation from one contact to the next. Only contacts
// reported below the desk determine it, because contacts above may be with low parts of an object.
//
// The model does not cover objects that yield more than the desk, nor sideways errors of the tool: contacts with the
// desk do not show these.
#pragma once

#include "gp/offset_model.hpp"
#include "solids/surface_touch.hpp"

#include <vector>

namespace palpate {

class Overtravel {
 public:
  /// `tip`: radius of the tool's round tip, metres. Contacts more than `most` above the desk are never with the desk.
  Overtravel(double tip, double most);

  /// Adds a touch as the arm reported it; in `told`, z is 0 on the desk. `force`: force of the contact, newtons.
  void add(const SurfaceTouch& told, double force);

  /// Returns a touch with its corrected length and whether it ended on the desk.
  SurfaceTouch read(const SurfaceTouch& told, double force) const;

  /// Returns the length to subtract from a contact with this force, metres.
  double at(double force) const;
  /// Returns the standard deviation of contact heights from one contact to the next, metres. It is at least
  /// kLeastSpread.
  double spread() const { return spread_; }
  static constexpr double kLeastSpread = 0.0005;

 private:
  struct LowContact {
    double height;  ///< height of the tip's lowest point, as reported
    double steep;   ///< vertical component of the direction, downwards
    double force;
  };
  double lowest_point(const SurfaceTouch& touch) const;
  double margin() const;

  double tip_;
  double most_;
  OffsetModel offset_model_;
  std::vector<LowContact> lows_;  ///< contacts that may be with the desk, in the order of offset_model_
  double spread_ = kLeastSpread;
};

}  // namespace palpate
