// SPDX-License-Identifier: MIT
#include "gp/posterior.hpp"

#include "gp/axis_basis.hpp"

#include <fmt/format.h>

namespace palpate {
namespace {

/// Multiplications a candidate and tap. Those of `grid` grow with the taps; those of `lowrank` do not, but for what it
/// does in its own coordinates, once a tap.
double cost_of_grid(double taps) { return 0.5 * taps; }

double cost_of_lowrank(double taps, double rank_x, double rank_y, const Candidates& candidates) {
  const double own = rank_x * rank_y * (0.5 * taps + candidates.rows);
  return rank_x + own / candidates.size();
}

EngineChoice choose_separable(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates,
                              double error) {
  const auto grid = [&](std::string reason) -> EngineChoice {
    return {make_grid(settings.machine, kernel, candidates), std::move(reason)};
  };
  if (error > settings.accuracy) {
    return grid(
        fmt::format("the error bound of lowrank, {:.1e}, is above the accuracy {:.1e}", error, settings.accuracy));
  }
  // The rank is at least 1, and finding it is work that a short run would not earn back.
  constexpr double kShort = 24;
  if (settings.taps < kShort) return grid(fmt::format("separable kernel on a grid, {} taps", settings.taps));
  const int rank_x = axis_basis(kernel, 0, candidates.xs, settings.tolerance).rank();
  const int rank_y = axis_basis(kernel, 1, candidates.ys, settings.tolerance).rank();
  const std::string found =
      fmt::format("separable kernel of rank {} x {} on the grid, {} taps", rank_x, rank_y, settings.taps);
  if (cost_of_lowrank(settings.taps, rank_x, rank_y, candidates) >= cost_of_grid(settings.taps)) return grid(found);
  return {make_lowrank(settings.machine, kernel, candidates, settings.tolerance, false), found};
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
      return {make_lowrank(settings.machine, kernel, candidates, settings.tolerance, settings.single), kAsked};
    case PosteriorSettings::Kind::automatic:
      break;
  }
  if (!kernel.separable()) return dense("the kernel is not separable");
  if (!candidates.is_grid()) return dense("the candidates are no product grid");
  if (!(settings.accuracy > 0.0)) return dense("no error is allowed");
  return choose_separable(settings, kernel, candidates, error);
}

}  // namespace palpate
