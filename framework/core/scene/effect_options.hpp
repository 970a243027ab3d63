// SPDX-License-Identifier: MIT
// The part `scene.effects:` of a config.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/options.hpp>

namespace palpate {

/// One group for each member of Effects, absent by default.
struct EffectOptions : Options {
  Effects values;
  void list(Fields& fields) override;
};

}  // namespace palpate
