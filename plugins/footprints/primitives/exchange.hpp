// SPDX-License-Identifier: MIT
// What a touch tells of some pieces of an outline says nothing of others that lie apart. Where outlines are drawn again
// by their weights, those that go take over only the former, and keep their own of the latter: otherwise all that is
// known of one object would be copies of ever fewer outlines, while another is touched (local particle filters:
// Rebeschini and van Handel 2015).
#pragma once

#include "particle.hpp"

namespace palpate::footprints {

/// The pieces of `from` that a touch at `here` may tell of take the place of those of `to`, and their rows of depths
/// with them: those near it, and those that go together with one of these, as they are near it as well, or hold the
/// same touch of an object, in either outline. Returns false, and leaves `to` as it was, where nothing of it lies
/// apart, where the two do not see the touches alike, or where it would have more than `most` pieces. `objects`: all
/// bits of the bytes of touches that are of an object. What is weighed of `to` is to be weighed again.
bool take_over(const Particle& from, const Target& here, const LabelModel::Step* objects, int most, Particle& to);

}  // namespace palpate::footprints
