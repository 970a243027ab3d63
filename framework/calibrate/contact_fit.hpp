// SPDX-License-Identifier: MIT
// Fit of an arm's errors to contacts with a known scene, by maximum likelihood.
//
// A true contact at the requested position p has the error e = h(p + q) + b + d t + noise. Here q is normal with equal
// deviations along x and y. A false contact is anywhere on the path of the tool. Expectation maximisation (Dempster,
// Laird and Rubin 1977) finds the offset b, the drift d, the noise and the share of false contacts. It runs for each
// lateral deviation on a grid. The fit takes the most likely lateral deviation. Its interval is that of the profile
// likelihood. Only taps near steps of the surface determine the lateral deviation.
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
  const Scene* scene = nullptr;  ///< scene of the contact, with its objects in their positions at that time
  Target place;                  ///< requested position
  double elapsed = 0.0;          ///< arm time before the contact, seconds
  double height = 0.0;           ///< measured height minus the known error, metres
};

struct ContactFit {
  Estimated offset;                ///< metres; offset at the mean time of the contacts if there is a drift
  std::optional<Estimated> drift;  ///< metres per second; nullopt if not significantly different from 0
  Estimated noise;                 ///< standard deviation of a height, metres
  /// Standard deviation of the position along x and y, metres; nullopt if the taps do not determine it.
  std::optional<Estimated> lateral;
  Estimated false_share;      ///< share of false contacts among all contacts
  double mean_elapsed = 0.0;  ///< mean time of the contacts, seconds
};

/// Fits at least 3 contacts. False contacts are distributed uniformly over `range` metres of height.
ContactFit fit_contacts(const std::vector<KnownContact>& contacts, double range);

/// Compares a contact's height minus `offset` with all heights of its scene within 1 cm of its position. Returns by how
/// many metres the contact is above all of them (positive) or below all of them (negative), else 0.
double beyond_surface(const KnownContact& contact, double offset);

/// Returns the share `count` / `all` with Wilson's interval (1927). Both numbers may be fractional.
Estimated share_of(double count, double all);

}  // namespace palpate
