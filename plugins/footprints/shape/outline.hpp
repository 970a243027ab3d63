// SPDX-License-Identifier: MIT
// Outlines of objects as seen from above: a piece, two pieces, or a piece from which another is taken.
#pragma once

#include "piece.hpp"

namespace palpate::footprints {

/// One piece is a block or a cylinder. Two make an L, a T, or objects that lie apart. A piece without another is a
/// ring, a U, or once more an L.
struct Outline {
  enum class Kind { one, two, without };
  Kind kind = Kind::one;
  Piece first;
  Piece second;  ///< of no meaning where the kind is `one`

  bool contains(double x, double y) const {
    const bool in_first = first.contains(x, y);
    if (kind == Kind::one) return in_first;
    return kind == Kind::two ? in_first || second.contains(x, y) : in_first && !second.contains(x, y);
  }
};

}  // namespace palpate::footprints
