// SPDX-License-Identifier: MIT
// What a person watching the experiment sees: the surface as it is believed, the taps, the area, the next target.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

namespace palpate::baxter {

/// Shows the scene's frame in the robot's frame `base`. All lengths are metres in the frame of the scene.
class View {
 public:
  virtual ~View() = default;

  /// Where the arm goes now.
  virtual void target(const Target& place) = 0;

  /// A tap that touched something; others are not shown.
  virtual void tapped(const Target& place, double height, bool on_surface) = 0;

  /// The surface: one height and its standard deviation for each place.
  virtual void surface(const Points& places, const VectorView& height, const VectorView& deviation) = 0;
};

}  // namespace palpate::baxter
