// SPDX-License-Identifier: MIT
// Engines: three algorithms that update the maps over the candidates after a tap, and the choice of an engine.
//
// There are n taps and M candidates. L is the Cholesky factor of the covariance matrix of the taps, K_* contains the
// covariances between taps and candidates, and V = L^-1 K_*. A new tap adds one row v to V and updates the maps:
//     mean += b v,   variance -= v^2,
// where b is the tap's entry of L^-1 targets. The engines differ in the computation of v:
//     dense    v = (k_* - l^T V) / d, from all earlier rows of V     O(n M) time and memory
//     grid     v = sum_i c_i f_x(x_i, X) f_y(y_i, Y)                 O(n M) time, O(M + n G) memory
//     lowrank  v = U_y (P_y^T diag(c) P_x) U_x^T                     O(r M + n (r^2 + n)) time, O(M + n r) memory
// The symbols are:
//     l, d        new row of L without its pivot, and the pivot
//     c           new row of L^-1
//     k_*         covariances of the new tap with the candidates
//     G, X, Y     for `grid` and `lowrank`, the candidates are a grid of G x G positions: columns at X, rows at Y
//     f_x, f_y    factors of the separable kernel along x and y
//     U_x, U_y    orthonormal bases of the covariances along x and y on the grid, of rank r within a tolerance
//     P_x, P_y    coordinates of the taps' covariances along x and y in these bases
#pragma once

#include "gp/map_tiles.hpp"

#include <palpate/kernel.hpp>

#include <memory>
#include <string>

namespace palpate {

/// New row of the Cholesky factor. It belongs to the tap in the last row of `positions`.
struct FactorRow {
  PointsView positions;  ///< positions of all n rows so far, this row included
  VectorView factor;     ///< l, n - 1 values
  double pivot;
  VectorView inverse;          ///< c, n values; empty unless needs_inverse()
  const double* coefficients;  ///< b, one value per mean
};

class Engine {
 public:
  virtual ~Engine() = default;

  const char* name() const { return name_; }
  /// Reserves memory for this many rows, up to a limit.
  virtual void reserve(int rows) = 0;
  /// Returns whether absorb() needs the new row of L^-1.
  virtual bool needs_inverse() const = 0;

  /// Resets the maps to the prior. Afterwards there are `means` maps of means. `prior` contains the kernel variance at
  /// each candidate, or a single value if all are equal.
  void restart(int means, const VectorView& prior) {
    clear();
    maps_.restart(means, prior);
  }

  /// Updates the maps with a row of the factor.
  virtual void absorb(const FactorRow& row) = 0;

  /// Returns one value per row: the largest error of the covariances between the row's tap and the candidates, in the
  /// unit of the kernel. The value contains the error of the engine's approximation, but not the rounding of the
  /// kernel. The result is empty for an engine without approximation.
  virtual VectorView covariance_errors() const { return Eigen::VectorXd(); }

  const MapTiles& maps() const { return maps_; }

 protected:
  Engine(const char* name, const std::shared_ptr<Workers>& workers, const Kernel& kernel,
         const CandidateGrid& candidates, const Tiling& tiling)
      : name_(name), workers_(workers), kernel_(kernel), candidates_(candidates), maps_(tiling, workers) {}

  /// Removes all rows.
  virtual void clear() = 0;

  const char* name_;
  std::shared_ptr<Workers> workers_;
  const Kernel& kernel_;
  const CandidateGrid& candidates_;
  MapTiles maps_;
};

/// Create an engine. `kernel` and `candidates` must outlive the engine, and the hyperparameters of the kernel must not
/// change. `grid` and `lowrank` need a separable kernel and a product grid.
std::unique_ptr<Engine> make_dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                   const CandidateGrid& candidates);
std::unique_ptr<Engine> make_grid(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                  const CandidateGrid& candidates);
/// `tolerance`: largest variance that the basis may leave out, as a share of the largest variance; see axis_basis().
std::unique_ptr<Engine> make_lowrank(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                     const CandidateGrid& candidates, double tolerance);

/// The block `engine` of a config.
struct EngineSettings {
  enum class Kind { automatic, dense, grid, lowrank };

  Kind engine = Kind::automatic;
  /// With `automatic`: largest error that the chosen engine may have in addition to the rounding errors of `dense`.
  /// Errors of means are in prior standard deviations, errors of variances in prior variances.
  double accuracy = 1e-9;
  double tolerance = 1e-15;  ///< tolerance of `lowrank`; see make_lowrank()
  int taps = 64;             ///< expected number of taps, for the reserved memory and for the choice by `automatic`
  std::shared_ptr<Workers> workers = std::make_shared<Workers>(1);
};

struct EngineChoice {
  std::unique_ptr<Engine> engine;
  std::string reason;  ///< reason of the choice: one line without a comma, because it becomes a cell of a CSV file
};

/// Returns the reason why the settings cannot be used with this kernel and these candidates, as a clause without a full
/// stop. Returns an empty text if they can be used. `grid` and `lowrank` need a separable kernel and a product grid.
std::string objection(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates);

/// Creates the engine that the settings name. With `automatic`, creates the fastest admissible engine. `error` is the
/// error bound of `lowrank`; `lowrank` is not admissible if this bound exceeds the accuracy. objection() must have
/// returned an empty text for the settings. Kernel and candidates must outlive the engine.
EngineChoice choose_engine(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates,
                           double error = 0.0);

}  // namespace palpate
