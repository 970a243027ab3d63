// SPDX-License-Identifier: MIT
// How far a tool has gone beyond a surface along its way by the time that a contact with it is told, learnt from the
// desk, whose height is known; and, by that, which contacts are with the desk.
//
// What is touched gives way under the force, and an arm that trails its set-point or hears late comes further. So a
// contact is told too deep by a + b F, with F the force of the contact; a and b are learnt as OffsetModel learns offset
// and drift (gp/offset_model.hpp), the force in the place of the time. Never less than 0: a tool is not stopped
// by what it has not reached. So where contacts with the desk lie on it, nothing is changed.
//
// By how much contacts err from one to the next, the spread, is seen below the desk alone: what is above it may be a
// low part of an object.
//
// What an object gives way beyond the desk is not in it, nor what the tool is off sideways: no contact with the desk
// tells.
#pragma once

#include "gp/offset_model.hpp"
#include "solids/surface_touch.hpp"

#include <vector>

namespace palpate {

class Overtravel {
 public:
  /// `tip`: radius of the tool's round tip, metres. No contact higher than `most` above the desk is with it.
  Overtravel(double tip, double most);

  /// Takes in a touch as the arm told it, relative to the desk, and the force of the contact, newtons.
  void add(const SurfaceTouch& told, double force);

  /// A touch as it is read now: where its way ended, and whether that is on the desk.
  SurfaceTouch read(const SurfaceTouch& told, double force) const;

  /// To be taken off the way of a contact with such a force, metres.
  double at(double force) const;
  /// Standard deviation with which heights of contacts err from one to the next, metres, at least kLeastSpread: less
  /// was not asked of the desk so far.
  double spread() const { return spread_; }
  static constexpr double kLeastSpread = 0.0005;

 private:
  struct Low {
    double height;  ///< of the tip's lowest point, as it was told
    double steep;   ///< share of the way that goes down
    double force;
  };
  double lowest_point(const SurfaceTouch& touch) const;
  double margin() const;

  double tip_;
  double most_;
  OffsetModel offset_model_;
  std::vector<Low> lows_;  ///< contacts that may be with the desk, as offset_model_ counts them
  double spread_ = kLeastSpread;
};

}  // namespace palpate
