// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

#include "gp/axis_basis.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

using Kind = EngineSettings::Kind;

/// An engine by its kind, and why that one.
struct Choice {
  Kind engine;
  std::string reason;
};

Choice choose_kind(const EngineSettings& settings, const Kernel& kernel, const Candidates& candidates, double error) {
  if (settings.engine != Kind::automatic) return {settings.engine, "chosen by engine.type"};
  if (!kernel.separable()) return {Kind::dense, "the kernel is not separable"};
  if (!candidates.is_grid()) return {Kind::dense, "the candidates are not a product grid"};
  if (!(settings.accuracy > 0.0)) return {Kind::dense, "no error is allowed"};
  if (error > settings.accuracy) {
    return {Kind::grid,
            fmt::format("the error bound of lowrank {:.1e} is above the accuracy {:.1e}", error, settings.accuracy)};
  }
  // Multiplications a candidate and tap: those of `grid` grow with the taps; `lowrank` has half its rank, as grids are
  // their own mirror image, and what it does in its own coordinates once a tap. A short run earns back no basis.
  const double of_grid = 0.5 * settings.taps;
  constexpr double kShort = 12;
  if (of_grid < kShort) return {Kind::grid, fmt::format("separable kernel on a grid and {} taps", settings.taps)};
  const int x = axis_rank(kernel, 0, candidates.xs, settings.tolerance, settings.taps);
  const int y = axis_rank(kernel, 1, candidates.ys, settings.tolerance, settings.taps);
  // Each tap would bring a direction of its own, and the basis alone could cost more than all of them.
  if (std::max(x, y) >= settings.taps)
    return {Kind::grid, fmt::format("separable kernel of a rank that {} taps do not reach", settings.taps)};
  const double of_lowrank = 0.5 * x + static_cast<double>(x) * y * (of_grid + candidates.rows) / candidates.size();
  return {of_lowrank < of_grid ? Kind::lowrank : Kind::grid,
          fmt::format("separable kernel of rank {} x {} on a grid and {} taps", x, y, settings.taps)};
}

}  // namespace

std::string objection(const EngineSettings& settings, const Kernel& kernel, const Candidates& candidates) {
  if (settings.engine == Kind::automatic || settings.engine == Kind::dense) return {};
  if (!kernel.separable()) return "the kernel is not a product of a factor along x and a factor along y";
  if (!candidates.is_grid()) return "the candidates are not a product grid";
  return {};
}

EngineChoice choose_engine(const EngineSettings& settings, const Kernel& kernel, const Candidates& candidates,
                           double error) {
  Choice choice = choose_kind(settings, kernel, candidates, error);
  const std::shared_ptr<Workers>& workers = settings.workers;
  return {choice.engine == Kind::dense  ? make_dense(workers, kernel, candidates)
          : choice.engine == Kind::grid ? make_grid(workers, kernel, candidates)
                                        : make_lowrank(workers, kernel, candidates, settings.tolerance),
          std::move(choice.reason)};
}

}  // namespace palpate
