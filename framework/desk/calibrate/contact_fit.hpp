// SPDX-License-Identifier: MIT
// What contacts with a scene that is known say of the arm: where they lie beside what they should have met.
//
// A contact is a true one, e = h(p + q) + b + d t + noise, q normal along x and y alike, or false, anywhere on the way
// down. Offset, drift, noise and the share of false ones are found by expectation maximisation (Dempster, Laird and
// Rubin 1977) for each deviation of the place on a grid, of which the likeliest is taken; its interval is that of the
// profile likelihood. Only where heights differ beside a tap does anything tell of the place.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// A value, and an interval of 95 %.
struct Estimated {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct KnownContact {
  const Scene* scene = nullptr;  ///< as it stands
  Target place;                  ///< where it was asked for
  double elapsed = 0.0;          ///< seconds of the arm's time before it
  double height = 0.0;           ///< metres, less what is known to be added to it
};

struct ContactFit {
  Estimated offset;                  ///< metres; at the middle of the time where there is a drift
  std::optional<Estimated> drift;    ///< metres a second; none where it cannot be told from 0
  Estimated noise;                   ///< of a height, standard deviation, metres
  std::optional<Estimated> lateral;  ///< of the place, likewise; none where these taps do not tell
  Estimated false_share;             ///< of the contacts
  double mean_elapsed = 0.0;         ///< of the contacts, seconds
};

/// False contacts lie anywhere over `range` metres. At least 3 contacts.
ContactFit fit_contacts(const std::vector<KnownContact>& contacts, double range);

/// Returns how far a contact is above (positive) or below (negative) all heights of its scene within 1 cm of its place,
/// metres, once `offset` is taken off its height; 0 for one among them.
double beyond_surface(const KnownContact& contact, double offset);

/// Of `count` among `all`, both of which may be fractions of taps (Wilson 1927).
Estimated share_of(double count, double all);

}  // namespace palpate
