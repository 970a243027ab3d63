// SPDX-License-Identifier: MIT
#include "solids/solids_options.hpp"

namespace palpate {

void ResidualOptions::list(Fields& fields) {
  fields.real(signal, Field("signal", "prior standard deviation of the distance between the particle and the surface")
                          .in(Unit::metre)
                          .at_least(1e-12)
                          .at_most(1e12));
  fields.real(noise, Field("noise", "standard deviation of the noise of one contact along the surface normal")
                         .in(Unit::metre)
                         .at_least(0)
                         .at_most(1e12));
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
                  .at_least(0)
                  .at_most(kUpright * (1 + 1e-12)));
  fields.integer(rays, Field("rays", "number of camera rays, rounded to a square number").at_least(16).at_most(40000));
}

void SolidsOptions::list(Fields& fields) {
  fields.section(residual, Field("residual", "settings of the residual GP, which corrects the most probable particle"));
  fields.integer(
      particles,
      Field("particles", "number of particles. A particle is one hypothesis of the scene, made of simple solids")
          .at_least(2)
          .at_most(1000));
  fields.integer(
      moves,
      Field("moves",
            "number of Monte Carlo moves per particle after each tap. The moves fit the particle to the contacts")
          .at_least(0)
          .at_most(100000));
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
