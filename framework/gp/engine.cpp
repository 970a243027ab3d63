// SPDX-License-Identifier: MIT
#include "gp/engine.hpp"

#include "gp/axis_basis.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

using Kind = EngineSettings::Kind;

struct KindChoice {
  Kind engine;
  std::string reason;
};

KindChoice choose_kind(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates,
                       double error) {
  if (settings.engine != Kind::automatic) return {settings.engine, "chosen by belief.engine.type"};
  if (!kernel.separable()) return {Kind::dense, "the kernel is not separable"};
  if (!candidates.is_grid()) return {Kind::dense, "the candidates are not a product grid"};
  if (!(settings.accuracy > 0.0)) return {Kind::dense, "no error is allowed"};
  if (error > settings.accuracy)
    return {Kind::grid,
            fmt::format("the error bound of lowrank {:.1e} is above the accuracy {:.1e}", error, settings.accuracy)};
  // Average numbers of multiplications per candidate and tap. `grid` needs one multiplication per earlier tap.
  // `lowrank` needs half of the rank, because the grid is symmetric. In addition, each tap needs matrix products in the
  // coordinates of the basis. In a short run, the computation of the basis costs more than it saves.
  const double of_grid = 0.5 * settings.taps;
  constexpr double kFewestForLowrank = 12;
  if (of_grid < kFewestForLowrank)
    return {Kind::grid, fmt::format("separable kernel on a grid and {} taps", settings.taps)};
  const int x = axis_rank(kernel, 0, candidates.xs, settings.tolerance, settings.taps);
  const int y = axis_rank(kernel, 1, candidates.ys, settings.tolerance, settings.taps);
  // With a rank above the number of taps, `lowrank` saves nothing.
  if (std::max(x, y) >= settings.taps)
    return {Kind::grid, fmt::format("separable kernel of a rank that {} taps do not reach", settings.taps)};
  const double of_lowrank = 0.5 * x + static_cast<double>(x) * y * (of_grid + candidates.rows) / candidates.size();
  return {of_lowrank < of_grid ? Kind::lowrank : Kind::grid,
          fmt::format("separable kernel of rank {} x {} on a grid and {} taps", x, y, settings.taps)};
}

}  // namespace

std::string objection(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates) {
  if (settings.engine == Kind::automatic || settings.engine == Kind::dense) return {};
  if (!kernel.separable()) return "the kernel is not a product of a factor along x and a factor along y";
  if (!candidates.is_grid()) return "the candidates are not a product grid";
  return {};
}

EngineChoice choose_engine(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates,
                           double error) {
  KindChoice choice = choose_kind(settings, kernel, candidates, error);
  const std::shared_ptr<Workers>& workers = settings.workers;
  return {choice.engine == Kind::dense  ? make_dense(workers, kernel, candidates)
          : choice.engine == Kind::grid ? make_grid(workers, kernel, candidates)
                                        : make_lowrank(workers, kernel, candidates, settings.tolerance),
          std::move(choice.reason)};
}

}  // namespace palpate
