// SPDX-License-Identifier: MIT
// By how much the surface is off the simple solids: a Gaussian process over the signed distance whose mean is theirs.
//
//     f(x) = m(x) - g(x),   g ~ GP(0, s^2 k(|x - x'|) (1 + n(x) . n(x')) / 2)
//
// m is the distance to the assembly, n its gradient of unit length; the surface is where f is 0. The factor of the
// normals, one half of a constant and of a linear kernel, keeps what is learnt of one side of a thin wall from the
// other. As a product of kernels of space and of the normals it is positive definite wherever k is so in space.
//
// What is known of g, in the order of the rows:
//
//     a contact             f = 0:  g = m(x), with the noise of a contact
//     a normal felt there   f rises along it alone: t . grad g = t . grad m for two directions t across it, with the
//                           normals of the assembly held
//     a free way            f >= 0: g <= m(x), at points of it; one that would be broken holds as a contact does, the
//                           others say nothing
//
// So the mean is the most probable g where a free point that lies inside by d costs d^2 / 2 noise^2, as a contact that
// is off by d does, and one outside costs nothing: the optimum of a strictly convex problem, found exactly. Of each
// stretch of a way inside the surface the deepest point is taken, until no way is inside by more than its noise but at
// points that were. The variance is that of a process which knows contacts and normals alone: what a free way takes off
// it is less than a contact in its place would, and where it is none, nothing.
#pragma once

#include "regular/regular_factor.hpp"
#include "solids/free_paths.hpp"
#include "solids/residual_kernel.hpp"
#include "solids/solids.hpp"

#include <palpate/kernel.hpp>
#include <palpate/types.hpp>

#include <Eigen/Core>

#include <memory>
#include <utility>
#include <vector>

namespace palpate {

struct ResidualGpSettings {
  double most = 0.006;    ///< largest signal, metres: it is that of the touches, if that is less
  double noise = 0.0005;  ///< of a contact, metres
  double tilt = 0.02;     ///< noise of a normal that is felt, radian
};

class ResidualGp {
 public:
  using Place = ResidualKernel::Place;
  using Places = ResidualKernel::Places;
  using Row = ResidualKernel::Row;

  /// Throws Error unless the kernel depends on the distance alone.
  ResidualGp(std::shared_ptr<const Kernel> kernel, const ResidualGpSettings& settings)
      : kernel_(std::move(kernel)), settings_(settings) {}

  /// Of contacts from the next fit on, metres.
  void set_noise(double noise) { settings_.noise = noise; }

  /// The process over `solids` after these touches; nothing is kept of either but what follows from them. Throws Error
  /// where a touch has a normal and the kernel no slopes.
  void fit(const Assembly& solids, const std::vector<SurfaceTouch>& touches);

  /// By how much the surface lies outside the assembly's, near such a place of it, metres.
  double mean(const Place& place) const;
  /// What contacts are off as a rule, and the standard deviation before any touch: that times the kernel's.
  double signal() const { return kernel_.signal(); }
  double deviation() const { return kernel_.deviation(); }
  /// How far from the assembly's the surface may be, metres: mean() is between -reach() and reach(). Mesh, volume
  /// and free ways ask no farther.
  double reach() const { return known_.reach(kernel_); }

  // Of many at once, which is much quicker.
  Eigen::VectorXd means(const Places& places) const { return known_.means(kernel_, places); }
  struct Posterior {
    Eigen::VectorXd mean, variance;
    int clamped = 0;  ///< variances that rounding had taken below 0, and that are 0
  };
  Posterior posterior(const Places& places) const;

  /// The covariance of g between all of these before any touch, with the signal of the last fit, noise left out.
  Eigen::MatrixXd covariance(const std::vector<Row>& rows) const {
    const ResidualKernel::Table table = ResidualKernel::table_of(rows);
    return kernel_.covariances(table, table);
  }
  /// Of a contact, metres.
  double noise() const { return settings_.noise; }

  /// The data that hold and are not set aside.
  const std::vector<Row>& rows() const { return known_.rows; }
  /// The free paths of the last fit. Points that hold are among the rows.
  const FreePaths& free_paths() const { return free_paths_; }

  /// What is added to the diagonal by need, as a share of each entry, and how often that was raised, all fits together;
  /// how often the matrix was singular even so, and how many rows do not enter now for that. Free ways have no part in
  /// it but of the last: a point with which the matrix would be singular is set aside.
  const FactorReport& report() const { return report_; }

 private:
  /// With as much jitter as it takes, and as many rows as it allows.
  void take_in(std::vector<Row> rows);
  std::vector<Row> contacts_of(const Assembly& solids, const std::vector<SurfaceTouch>& touches) const;

  ResidualKernel kernel_;
  ResidualGpSettings settings_;
  ResidualData known_;
  FreePaths free_paths_;
  FactorReport report_;
};

}  // namespace palpate
