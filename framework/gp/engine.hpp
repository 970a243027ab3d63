// SPDX-License-Identifier: MIT
// Engines: three algorithms that add a row of the factor to the maps over the candidates, and the choice of an engine.
//
// Let L be the factor of the covariance of n taps, K_* their covariance with the candidates, and V = L^-1 K_*. A tap
// adds one row v to V, and
//     mean += v b,   variance -= v^2,
// where b is its entry of L^-1 targets. The engines differ in the computation of v. With l the new row of L, d its
// pivot and c the new row of L^-1:
//     dense    v = (k_* - l^T V) / d, from all earlier rows of V     O(n M) time and memory
//     grid     v = sum_i c_i f_x(x_i, X) f_y(y_i, Y)                 O(n M) time, O(M + n G) memory
//     lowrank  v = U_y (P_y^T diag(c) P_x) U_x^T                     O(r M + n (r^2 + n)) time, O(M + n r) memory
// for M candidates, which form a grid of G x G positions for `grid` and `lowrank`. f is the factor of the kernel along
// one axis, U an orthonormal basis of its covariances on the grid of rank r within a tolerance, and P the coordinates
// of the taps' covariances in this basis.
#pragma once

#include "gp/maps.hpp"

#include <palpate/kernel.hpp>

#include <memory>
#include <string>

namespace palpate {

/// One row of the factor, for the tap in the last row of `positions`.
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
  /// Returns whether absorb() reads the row of L^-1.
  virtual bool needs_inverse() const = 0;

  /// Resets the maps to the prior, with `means` maps of means. `prior` is the kernel variance at the candidates, or one
  /// value if all are equal.
  void restart(int means, const VectorView& prior) {
    clear();
    maps_.restart(means, prior);
  }

  /// Adds a row to the maps.
  virtual void absorb(const FactorRow& row) = 0;

  /// Returns, per row, the largest error of a covariance between its tap and a candidate, in the unit of the kernel. It
  /// is the error of the engine's approximation, without the rounding of the kernel. Empty for an engine without
  /// approximation.
  virtual VectorView covariance_errors() const { return Eigen::VectorXd(); }

  const Maps& maps() const { return maps_; }

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
  Maps maps_;
};

/// Create an engine. `kernel` and `candidates` must outlive the engine, and the hyperparameters of the kernel must not
/// change. `grid` and `lowrank` need a separable kernel and a product grid.
std::unique_ptr<Engine> make_dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                   const CandidateGrid& candidates);
std::unique_ptr<Engine> make_grid(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                  const CandidateGrid& candidates);
/// `tolerance`: residual variance of the basis relative to the largest variance; see axis_basis().
std::unique_ptr<Engine> make_lowrank(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                     const CandidateGrid& candidates, double tolerance);

/// Block `engine` of a config.
struct EngineSettings {
  enum class Kind { automatic, dense, grid, lowrank };

  Kind engine = Kind::automatic;
  /// Largest error of `automatic` beyond the rounding of `dense`, of means in prior standard deviations and of
  /// variances in prior variances.
  double accuracy = 1e-9;
  double tolerance = 1e-15;  ///< tolerance of `lowrank`; see make_lowrank()
  int taps = 64;             ///< expected number of taps, for memory and the choice by `automatic`
  std::shared_ptr<Workers> workers = std::make_shared<Workers>(1);
};

struct EngineChoice {
  std::unique_ptr<Engine> engine;
  std::string reason;  ///< one line without a comma, because it becomes a cell of a CSV
};

/// Returns the reason why the settings cannot be used with this kernel and these candidates, as the end of a sentence.
/// Empty if they can. `grid` and `lowrank` need a separable kernel and a product grid.
std::string objection(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates);

/// Creates the engine of the settings, or for `automatic` the fastest admissible engine. `lowrank` is not admissible if
/// its error bound `error` exceeds the accuracy. There must be no objection() to the settings. Kernel and candidates
/// must outlive the engine.
EngineChoice choose_engine(const EngineSettings& settings, const Kernel& kernel, const CandidateGrid& candidates,
                           double error = 0.0);

}  // namespace palpate
