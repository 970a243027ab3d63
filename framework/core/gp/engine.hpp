// SPDX-License-Identifier: MIT
// Engines: three ways to bring one more row of the factor to the maps over the candidates; and which one is taken.
//
// With L the factor of the covariance of n taps, K_* their covariance with the candidates and V = L^-1 K_*, a tap adds
// one row v to V, and
//     mean += v b,   variance -= v^2,
// b its entry of L^-1 targets. The engines differ in how they come to v, with l the new row of L, d its pivot and
// c the new row of L^-1:
//     dense    v = (k_* - l^T V) / d, of all earlier rows of V       O(n M) time and memory
//     grid     v = sum_i c_i f_x(x_i, X) f_y(y_i, Y)                 O(n M) time, O(M + n G) memory
//     lowrank  v = U_y (P_y^T diag(c) P_x) U_x^T                     O(r M + n (r^2 + n)) time, O(M + n r) memory
// for M candidates, in a grid of G x G places for the latter two; f is the factor of the kernel along one axis, U an
// orthonormal basis of the r directions that its covariances on the grid have within a tolerance, and P the coordinates
// of the taps' covariances in it.
#pragma once

#include "gp/maps.hpp"

#include <palpate/kernel.hpp>

#include <memory>
#include <string>

namespace palpate {

/// One row of the factor, for the tap in the last row of `places`.
struct FactorRow {
  PointsView places;  ///< of all n rows so far, this one included
  VectorView factor;  ///< l, n - 1 values
  double pivot;
  VectorView inverse;          ///< c, n values; empty for an engine that does without
  const double* coefficients;  ///< b of every mean
};

class Engine {
 public:
  virtual ~Engine() = default;

  const char* name() const { return name_; }
  /// Room for so many rows, as far as that is reasonable.
  virtual void reserve(int rows) = 0;
  /// Whether absorb() reads the row of L^-1.
  virtual bool needs_inverse() const = 0;

  /// Back to the prior, with `means` maps of means. `prior` is the variance of the kernel at the candidates, one number
  /// if it is the same at all.
  void restart(int means, const VectorView& prior) {
    clear();
    maps_.restart(means, prior);
  }

  /// Takes one more row into the maps.
  virtual void absorb(const FactorRow& row) = 0;

  /// Of each row so far the largest error of a covariance between its tap and a candidate, in the unit of the kernel:
  /// what the engine leaves away, beyond what the kernel itself may be off by rounding. Empty where nothing is left
  /// away.
  virtual VectorView covariance_errors() const { return Eigen::VectorXd(); }

  const Maps& maps() const { return maps_; }

 protected:
  Engine(const char* name, const std::shared_ptr<Workers>& workers, const Kernel& kernel, const Candidates& candidates,
         const Tiling& tiling)
      : name_(name), workers_(workers), kernel_(kernel), candidates_(candidates), maps_(tiling, workers) {}

  /// Forgets all rows.
  virtual void clear() = 0;

  const char* name_;
  std::shared_ptr<Workers> workers_;
  const Kernel& kernel_;
  const Candidates& candidates_;
  Maps maps_;
};

/// `kernel` and `candidates` must outlive the engines, and the hyperparameters of the kernel stay as they are. The
/// latter two need a separable kernel and a product grid.
std::unique_ptr<Engine> make_dense(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                   const Candidates& candidates);
std::unique_ptr<Engine> make_grid(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                  const Candidates& candidates);
/// Directions whose share of a covariance is below `tolerance` are left out.
std::unique_ptr<Engine> make_lowrank(const std::shared_ptr<Workers>& workers, const Kernel& kernel,
                                     const Candidates& candidates, double tolerance);

struct EngineSettings {
  enum class Kind { automatic, dense, grid, lowrank };

  Kind engine = Kind::automatic;
  /// What `automatic` may lose beyond the rounding of `dense`: of means in prior standard deviations, of variances in
  /// prior variances.
  double accuracy = 1e-9;
  double tolerance = 1e-15;  ///< of `lowrank`: see make_lowrank()
  int taps = 64;             ///< that are expected: room is made for them, and `automatic` weighs engines by them
  std::shared_ptr<Workers> workers = std::make_shared<Workers>(1);
};

struct EngineChoice {
  std::unique_ptr<Engine> engine;
  std::string reason;  ///< one line, without a comma: it becomes a cell of tables
};

/// Why these settings cannot be used with this kernel, the end of a sentence; empty if they can: `grid` and `lowrank`
/// need a kernel that is separable and candidates that are a product grid.
std::string objection(const EngineSettings& settings, const Kernel& kernel, const Candidates& candidates);

/// The engine that was asked for, or the fastest that is admissible; `lowrank` is not any more when its error has been
/// found too large, `error` > accuracy. Settings to which there is no objection. The kernel and the candidates must
/// outlive the engine.
EngineChoice choose_engine(const EngineSettings& settings, const Kernel& kernel, const Candidates& candidates,
                           double error = 0.0);

}  // namespace palpate
