// SPDX-License-Identifier: MIT
#include "solids/solids_options.hpp"

namespace palpate {

void ResidualOptions::list(Fields& fields) {
  fields.real(signal, Field("signal", "prior standard deviation of the distance between the particle and the surface")
                          .in(Unit::metre)
                          .within(1e-12, 1e12));
  fields.real(noise, Field("noise", "standard deviation of the noise of one contact along the surface normal")
                         .in(Unit::metre)
                         .within(0, 1e12));
}

void SideViewOptions::list(Fields& fields) {
  constexpr double kUpright = 3.14159265358979323846 / 2;
  fields.real(azimuth, Field("azimuth",
                             "azimuth of the camera, seen from the middle of the area and counter-clockwise from the x "
                             "axis; not given: drawn from the seed")
                           .in(Unit::radian));
  fields.real(elevation,
              Field("elevation", "elevation angle of the camera above the horizontal, seen from the middle of the area")
                  .in(Unit::radian)
                  .within(0, kUpright * (1 + 1e-12)));
  fields.integer(rays, Field("rays", "number of camera rays, rounded to a square number").within(16, 40000));
}

void SolidsOptions::list(Fields& fields) {
  fields.section(residual, Field("residual", "settings of the residual GP, which corrects the most probable particle"));
  fields.integer(
      particles,
      Field("particles", "number of particles. A particle is one hypothesis of the scene, made of simple solids")
          .within(2, 1000));
  fields.integer(
      moves,
      Field("moves",
            "number of Monte Carlo moves per particle after each tap. The moves fit the particle to the contacts")
          .within(0, 100000));
  fields.real(
      model_discrepancy,
      Field("model_discrepancy", "standard deviation between the objects' surfaces and the simple solids of the model")
          .in(Unit::metre)
          .at_least(1e-6));
  fields.section(view, Field("view",
                             "view of a camera at 60 cm distance, taken before the first tap; not given: no view. "
                             "Requires `backend: simulator`"));
}

}  // namespace palpate
