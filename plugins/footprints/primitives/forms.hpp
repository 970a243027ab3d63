// SPDX-License-Identifier: MIT
// Many forms, as vectors take them: in single precision, of which twice as many fit.
#pragma once

#include "form.hpp"

#include <cstdint>
#include <vector>

namespace palpate::footprints {

class Forms {
 public:
  void clear();
  void add(const Form& form);
  /// As often as add() was called.
  std::size_t size() const { return count_; }

  /// Sets to 1 what belongs to a form that meets another, as of meet() but for rounding: as many as there are forms,
  /// rounded up to kRound. What is not is set to 0, or, if this one is marked `too`, left as it is.
  static constexpr std::size_t kRound = 32;
  void mark_met(const Form& other, bool too, std::vector<std::uint8_t>& met) const;
  /// Adds up what was marked so; up to 255 times.
  static void count_met(const std::vector<std::uint8_t>& met, std::vector<std::uint8_t>& times);

 private:
  std::size_t count_ = 0;
  std::vector<float> x_, y_, a_, b_, cosine_, sine_, ellipse_;  ///< the last: 1 of an ellipse, 0 of a box
};

}  // namespace palpate::footprints
