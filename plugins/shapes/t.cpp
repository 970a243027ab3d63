// SPDX-License-Identifier: MIT
#include "prism/prism.hpp"

namespace palpate::shapes {

class T final : public Prism {
 public:
  using Options = BarsOptions;
  T(const Options& o, const Context&)
      : T(o, (o.length - o.thickness) / 2, (o.length + o.thickness) / 2, o.width - o.thickness) {}

 private:
  T(const Options& o, double left, double right, double under)
      : Prism({{left, 0},
               {right, 0},
               {right, under},
               {o.length, under},
               {o.length, o.width},
               {0, o.width},
               {0, under},
               {left, under}},
              {}, o.height) {}
};

PALPATE_PLUGIN(Shape, T, "t", "T of two bars. The second bar begins at the middle of the first bar")

}  // namespace palpate::shapes
