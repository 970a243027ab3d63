// SPDX-License-Identifier: MIT
// Which engine keeps the posterior over the candidates, and why.
#pragma once

#include "gp/engine.hpp"

#include <memory>
#include <string>

namespace palpate {

struct PosteriorSettings {
  enum class Kind { automatic, dense, grid, lowrank };

  Kind engine = Kind::automatic;
  /// What `automatic` may lose beyond the rounding of `dense`: of means in prior standard deviations, of variances in
  /// prior variances.
  double accuracy = 1e-9;
  double tolerance = 1e-15;  ///< of `lowrank`: see make_lowrank()
  int taps = 64;             ///< that are expected: room is made for them, and `automatic` weighs engines by them
  Machine machine;
};

struct EngineChoice {
  std::unique_ptr<Engine> engine;
  std::string reason;  ///< one line, without a comma: it becomes a cell of tables
};

/// Why these settings cannot be used with this kernel, the end of a sentence; empty if they can: `grid` and `lowrank`
/// need a kernel that is separable and candidates that are a product grid.
std::string objection(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates);

/// The engine that was asked for, or the fastest that is admissible; `lowrank` is not any more when its error has been
/// found too large, `error` > accuracy. Settings to which there is no objection. The kernel and the candidates must
/// outlive the engine.
EngineChoice choose_engine(const PosteriorSettings& settings, const Kernel& kernel, const Candidates& candidates,
                           double error = 0.0);

}  // namespace palpate
