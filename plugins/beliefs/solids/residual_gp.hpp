// SPDX-License-Identifier: MIT
// Residual GP: a Gaussian process over the signed distance to the surface. Its prior mean is the distance to the simple
// solids.
//
//     f(x) = m(x) - g(x),   g ~ GP(0, s^2 * k(|x - x'|) * (1 + n(x) . n(x')) / 2)
//
// m is the signed distance to the assembly, n its gradient of unit length; the surface is where f is 0. The factor with
// the normals is half the sum of a constant kernel and a linear kernel. It separates the two sides of a thin wall: data
// on one side do not affect the other. The product of a kernel of the position and a kernel of the normal is positive
// definite wherever k is positive definite in space.
//
// Data about g, in the order of the rows:
//
//     contact            f = 0: g = m(x), with the noise of a contact
//     measured normal    f changes only along the normal: t . grad g = t . grad m for two directions t perpendicular to
//                        it. The normals n of the assembly are treated as constant.
//     free path          f >= 0: g <= m(x) at points of the path. A point that would violate this holds the surface
//                        back like a contact; the other points have no effect.
//
// The mean is the most probable g under these costs of a free point (a point of a free path): d^2 / (2 * noise^2) at
// the depth d inside the surface, like a contact with the error d; 0 outside. This is the optimum of a strictly convex
// problem, and it is found exactly. In each round, the deepest point of each stretch of a path inside the surface is
// added to the data. The rounds end when no path is inside by more than its noise, except at added points. The variance
// is that of a GP with contacts and normals alone. A free path would reduce the variance by less than a contact at the
// same position, and not at all where it does not hold the surface back.
#pragma once

#include "regular/regular_factor.hpp"
#include "solids/assembly_sampler.hpp"
#include "solids/free_paths.hpp"
#include "solids/residual_kernel.hpp"

#include <palpate/kernel.hpp>
#include <palpate/types.hpp>

#include <Eigen/Core>

#include <memory>
#include <utility>
#include <vector>

namespace palpate {

struct ResidualGpSettings {
  double most = 0.006;    ///< metres, upper limit of the signal, which is the RMS distance of the contacts
  double noise = 0.0005;  ///< standard deviation of a contact, metres
  double tilt = 0.02;     ///< standard deviation of a measured normal, radians
};

class ResidualGp {
 public:
  using Place = ResidualKernel::Place;
  using Places = ResidualKernel::Places;
  using ResidualDatum = ResidualKernel::ResidualDatum;

  /// Throws Error unless the kernel depends on the distance alone.
  ResidualGp(std::shared_ptr<const Kernel> kernel, const ResidualGpSettings& settings)
      : kernel_(std::move(kernel)), settings_(settings) {}

  /// Sets the noise of contacts for all later fits, metres.
  void set_noise(double noise) { settings_.noise = noise; }

  /// Fits the GP over `solids` to these touches. It keeps no reference to either. Throws Error if a touch has a normal
  /// but the kernel has no gradient.
  void fit(const Assembly& solids, const std::vector<SurfaceTouch>& touches);

  /// Returns the mean of g: the distance by which the surface lies outside the assembly's surface near `place`, metres.
  double mean(const Place& place) const;
  /// signal(): Returns the RMS distance of the contacts from the assembly, within limits, metres. deviation(): Returns
  /// the prior standard deviation of g, metres: signal() times the kernel's standard deviation.
  double signal() const { return kernel_.signal(); }
  double deviation() const { return kernel_.deviation(); }
  /// Returns the largest distance between the surface and the assembly's surface, metres: mean() is between -reach()
  /// and reach(). Mesh, volume and free paths evaluate the GP only within this distance.
  double reach() const { return known_.reach(kernel_); }

  // Functions for many places at once, which are much faster.
  Eigen::VectorXd means(const Places& places) const { return known_.means(kernel_, places); }
  struct Posterior {
    Eigen::VectorXd mean, variance;
    int clamped = 0;  ///< number of variances that were negative because of rounding and were set to 0
  };
  Posterior posterior(const Places& places) const;

  /// Returns the prior covariance of g between all rows, with the signal of the last fit and without noise.
  Eigen::MatrixXd covariance(const std::vector<ResidualDatum>& rows) const {
    const ResidualKernel::DatumTable table = ResidualKernel::table_of(rows);
    return kernel_.covariances(table, table);
  }
  /// Returns the standard deviation of a contact, metres.
  double noise() const { return settings_.noise; }

  /// Returns the data in use: contacts, normals, and the points of free paths that hold the surface back.
  const std::vector<ResidualDatum>& rows() const { return known_.rows; }
  /// Returns the free paths of the last fit. Points that hold the surface back are among rows().
  const FreePaths& free_paths() const { return free_paths_; }

  /// Returns the report of the factorisations over all fits. Its jitter is a share of each diagonal entry. Free paths
  /// only contribute to the number of rows that are left out: points with which the matrix would be singular.
  const FactorReport& report() const { return report_; }

 private:
  /// Factorises with as much jitter as needed. If no jitter is sufficient, leaves rows out.
  void take_in(std::vector<ResidualDatum> rows);
  std::vector<ResidualDatum> contacts_of(const Assembly& solids, const std::vector<SurfaceTouch>& touches) const;

  ResidualKernel kernel_;
  ResidualGpSettings settings_;
  ResidualData known_;
  FreePaths free_paths_;
  FactorReport report_;
};

}  // namespace palpate
