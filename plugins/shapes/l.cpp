// SPDX-License-Identifier: MIT
#include "prism/prism.hpp"

namespace palpate::shapes {

class L final : public Prism {
 public:
  using Options = BarsOptions;
  L(const Options& o, const Context&) : L(o, o.thickness) {}

 private:
  L(const Options& o, double b)
      : Prism({{0, 0}, {o.length, 0}, {o.length, b}, {b, b}, {b, o.width}, {0, o.width}}, {}, o.height) {}
};

PALPATE_PLUGIN(Shape, L, "l", "L of two bars that meet at their ends")

}  // namespace palpate::shapes
