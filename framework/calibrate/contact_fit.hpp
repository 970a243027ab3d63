// SPDX-License-Identifier: MIT
// Fit of an arm's errors to contacts with a known scene, by maximum likelihood.
//
// A true contact at the requested position p and time t has the measured height h(p + q) + b + d * t + noise, where h
// is the height of the scene. The lateral error q is normal with equal standard deviations along x and y. A false
// contact is anywhere on the path of the tool. Expectation maximisation (Dempster, Laird and Rubin 1977) finds the
// offset b, the drift d, the noise and the share of false contacts. It runs for each value of the lateral standard
// deviation on a grid. The fit returns the most likely value, with the 95 % interval of its profile likelihood. Only
// taps near steps of the surface determine the lateral standard deviation.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// A value with its 95 % interval.
struct IntervalEstimate {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct KnownContact {
  /// scene of the contact, with the objects at their positions at the time of the contact
  const Scene* scene = nullptr;
  Target place;          ///< requested position
  double elapsed = 0.0;  ///< arm time before the contact, seconds
  double height = 0.0;   ///< measured height minus the simulated error of the assumed effects, metres
};

struct ContactFit {
  /// offset of the measured heights, metres; with a drift, the offset at the mean time of the contacts
  IntervalEstimate offset;
  std::optional<IntervalEstimate> drift;  ///< metres per second; nullopt if not significantly different from 0
  IntervalEstimate noise;                 ///< standard deviation of the noise of a measured height, metres
  /// Standard deviation of the lateral error along x and along y, metres; nullopt if the taps do not determine it.
  std::optional<IntervalEstimate> lateral;
  IntervalEstimate false_share;  ///< share of false contacts among all contacts
  double mean_elapsed = 0.0;     ///< mean time of the contacts, seconds
};

/// Fits at least 3 contacts. False contacts are distributed uniformly over `range` metres of height.
ContactFit fit_contacts(const std::vector<KnownContact>& contacts, double range);

/// Compares the height of a contact, minus `offset`, with all heights of the scene within 1 cm of the contact's
/// position. Returns the signed distance in metres to the range of these heights: positive above all heights, negative
/// below all heights, else 0.
double beyond_surface(const KnownContact& contact, double offset);

/// Returns the share `count` / `all` with Wilson's interval (1927). Both numbers may be fractional.
IntervalEstimate share_of(double count, double all);

}  // namespace palpate
