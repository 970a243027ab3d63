// SPDX-License-Identifier: MIT
#include "gp/posterior.hpp"

#include "gp/axis_basis.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

EngineChoice choose_separable(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates,
                              double error) {
  const auto grid = [&](std::string reason) -> EngineChoice {
    return {make_grid(settings.machine, kernel, candidates), std::move(reason)};
  };
  if (error > settings.accuracy) {
    return grid(
        fmt::format("the error bound of lowrank {:.1e} is above the accuracy {:.1e}", error, settings.accuracy));
  }
  // Multiplications a candidate and tap: those of `grid` grow with the taps; `lowrank` has half its rank, as grids are
  // their own mirror image, and what it does in its own coordinates once a tap. A short run earns back no basis.
  const double of_grid = 0.5 * settings.taps;
  constexpr double kShort = 12;
  if (of_grid < kShort) return grid(fmt::format("separable kernel on a grid and {} taps", settings.taps));
  const int x = axis_rank(kernel, 0, candidates.xs, settings.tolerance, settings.taps);
  const int y = axis_rank(kernel, 1, candidates.ys, settings.tolerance, settings.taps);
  // Each tap would bring a direction of its own, and the basis alone could cost more than all of them.
  if (std::max(x, y) >= settings.taps) {
    return grid(fmt::format("separable kernel of a rank that {} taps do not reach", settings.taps));
  }
  const double of_lowrank = 0.5 * x + static_cast<double>(x) * y * (of_grid + candidates.rows) / candidates.size();
  const std::string found = fmt::format("separable kernel of rank {} x {} on a grid and {} taps", x, y, settings.taps);
  if (of_lowrank >= of_grid) return grid(found);
  return {make_lowrank(settings.machine, kernel, candidates, settings.tolerance), found};
}

}  // namespace

std::string objection(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates) {
  using Kind = PosteriorSettings::Kind;
  if (settings.engine == Kind::automatic || settings.engine == Kind::dense) return {};
  if (!kernel.separable()) return "which is not separable: no product of a factor along x and one along y";
  if (!candidates.is_grid()) return "as the candidates are no product grid";
  return {};
}

EngineChoice choose_engine(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates,
                           double error) {
  const auto dense = [&](const char* reason) -> EngineChoice {
    return {make_dense(settings.machine, kernel, candidates), reason};
  };
  constexpr const char* kAsked = "asked for";
  switch (settings.engine) {
    case PosteriorSettings::Kind::dense:
      return dense(kAsked);
    case PosteriorSettings::Kind::grid:
      return {make_grid(settings.machine, kernel, candidates), kAsked};
    case PosteriorSettings::Kind::lowrank:
      return {make_lowrank(settings.machine, kernel, candidates, settings.tolerance), kAsked};
    case PosteriorSettings::Kind::automatic:
      break;
  }
  if (!kernel.separable()) return dense("the kernel is not separable");
  if (!candidates.is_grid()) return dense("the candidates are no product grid");
  if (!(settings.accuracy > 0.0)) return dense("no error is allowed");
  return choose_separable(settings, kernel, candidates, error);
}

}  // namespace palpate
