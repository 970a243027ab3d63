// SPDX-License-Identifier: MIT
// What an L and a T share: two bars of one thickness.
#pragma once

#include "prism.hpp"
#include "solid.hpp"

namespace palpate::shapes {

struct BarsOptions : Options {
  double length = 0.14;
  double width = 0.1;
  double thickness = 0.04;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.real(length, Field("length", "outer extent along the first bar").in(Unit::metre).above(0));
    fields.real(width, Field("width", "outer extent across it").in(Unit::metre).above(0));
    fields.real(thickness, Field("thickness", "of either bar, seen from above").in(Unit::metre).above(0));
    list_height(height, fields);
    fields.require(thickness < length && thickness < width, "thickness",
                   "is not less than length and width, nothing would be left of the second bar");
  }
};

}  // namespace palpate::shapes
