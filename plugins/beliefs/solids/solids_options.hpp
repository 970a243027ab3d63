// SPDX-License-Identifier: MIT
// The options of the belief `solids`.
#pragma once

#include <palpate/options.hpp>

#include <cstdint>
#include <optional>

namespace palpate {

/// GP of the distances between the most probable particle and the surface, metres.
struct ResidualOptions : Options {
  double signal = 0.006;
  double noise = 0.0005;
  void list(Fields& fields) override;
};

/// A camera's view before the first tap, see solids/camera_rays.hpp.
struct SideViewOptions : Options {
  std::optional<double> azimuth;  ///< radians; absent: drawn from the seed
  double elevation = 35.0 / 180.0 * 3.14159265358979323846;
  std::int64_t rays = 400;
  void list(Fields& fields) override;
};

struct SolidsOptions : Options {
  ResidualOptions residual;
  std::int64_t particles = 24;
  std::int64_t moves = 1000;
  double model_discrepancy = 0.002;  ///< metres
  std::optional<SideViewOptions> view;
  void list(Fields& fields) override;
};

}  // namespace palpate
