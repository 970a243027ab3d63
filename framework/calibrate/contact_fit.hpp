// SPDX-License-Identifier: MIT
// Fit of an arm's errors to contacts with a known scene.
//
// The error of a true contact is e = h(p + q) + b + d t + noise, where q is normal with equal deviations along x and y;
// a false contact is anywhere on the way down. Expectation maximisation (Dempster, Laird and Rubin 1977) finds offset
// b, drift d, noise and the share of false contacts for each lateral deviation on a grid. The most likely one is taken,
// with the interval of the profile likelihood. Only taps beside steps determine the lateral deviation.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// A value with its 95 % interval.
struct Estimated {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct KnownContact {
  const Scene* scene = nullptr;  ///< with its objects as they stand
  Target place;                  ///< requested position
  double elapsed = 0.0;          ///< arm time before the contact, seconds
  double height = 0.0;           ///< measured height, metres, minus the known error
};

struct ContactFit {
  Estimated offset;                  ///< metres; halfway through the taps if there is a drift
  std::optional<Estimated> drift;    ///< metres per second; nullopt if not significantly different from 0
  Estimated noise;                   ///< standard deviation of a height, metres
  std::optional<Estimated> lateral;  ///< standard deviation of the position along x and y, metres; nullopt if these
                                     ///< taps do not determine it
  Estimated false_share;             ///< share of the contacts
  double mean_elapsed = 0.0;         ///< mean time of the contacts, seconds
};

/// Fits at least 3 contacts. False contacts are uniform over `range` metres of height.
ContactFit fit_contacts(const std::vector<KnownContact>& contacts, double range);

/// Returns how far a contact's height minus `offset` is above (positive) or below (negative) all heights of its scene
/// within 1 cm of its position, in metres; 0 between them.
double beyond_surface(const KnownContact& contact, double offset);

/// Returns the share `count` / `all` with Wilson's interval (1927); both may be fractions of taps.
Estimated share_of(double count, double all);

}  // namespace palpate
