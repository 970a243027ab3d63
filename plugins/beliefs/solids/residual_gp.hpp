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

#include "gp/loops.hpp"
#include "regular/regular_factor.hpp"
#include "solids/solids.hpp"

#include <palpate/kernel.hpp>
#include <palpate/types.hpp>

#include <Eigen/Core>

#include <cmath>
#include <memory>
#include <vector>

namespace palpate {

struct ResidualGpSettings {
  double most = 0.006;    ///< largest signal, metres: it is that of the touches, if that is less
  double noise = 0.0005;  ///< of a contact, metres
  double tilt = 0.02;     ///< noise of a normal that is felt, radian
};

class ResidualGp {
 public:
  /// The kernel is asked for places on the desk, as far apart as those in space. Throws Error where it is not one of
  /// the distance alone.
  ResidualGp(std::shared_ptr<const Kernel> kernel, const ResidualGpSettings& settings);

  /// Of contacts from the next fit on, metres.
  void set_noise(double noise) { settings_.noise = noise; }

  /// The process over `solids` after these touches; nothing is kept of either but what follows from them. Throws Error
  /// where a touch has a normal and the kernel no slopes.
  void fit(const Assembly& solids, const std::vector<SurfaceTouch>& touches);

  struct Place {
    Eigen::Vector3d at, normal;
  };
  using Places = std::vector<Place>;

  /// By how much the surface lies outside the assembly's, near such a place of it, metres.
  double mean(const Place& place) const;
  double variance(const Place& place) const;
  /// What contacts are off as a rule, and the standard deviation before any touch: that times the kernel's.
  double signal() const { return signal_; }
  double deviation() const { return signal_ * std::sqrt(unit_); }
  /// How far from the assembly's the surface may be, metres: mean() is between -reach() and reach(). Mesh, volume
  /// and free ways ask no farther.
  double reach() const;

  // Of many at once, which is much quicker.
  Eigen::VectorXd means(const Places& places) const;
  struct Posterior {
    Eigen::VectorXd mean, variance;
    int clamped = 0;  ///< variances that rounding had taken below 0, and that are 0
  };
  Posterior posterior(const Places& places) const;

  /// The covariance of g between all of these before any touch.
  Eigen::MatrixXd prior_covariance(const Places& places) const;
  /// Of a contact, metres.
  double noise() const { return settings_.noise; }

  /// A row of what is known: of g itself or, where `along` is not 0, of its slope in that direction.
  struct Row {
    Place place;
    Eigen::Vector3d along;
    double target;
    double noise;  ///< standard deviation
    bool free;     ///< a point of a free way
  };
  /// Those that hold and are not set aside.
  const std::vector<Row>& rows() const { return known_.rows; }
  /// Free points that were found inside the surface at some time; those that hold are among the rows.
  const std::vector<Row>& free_points() const { return free_; }

  /// What is added to the diagonal by need, as a share of each entry, and how often that was raised, all fits together;
  /// how often the matrix was singular even so, and how many rows do not enter now for that. Free ways have no part in
  /// it but of the last: a point with which the matrix would be singular is set aside.
  const FactorReport& report() const { return report_; }
  /// Free ways that the surface is left in, by more than noise and elsewhere than at points that hold: the last fit
  /// ended before it had seen to them.
  int violated_free_paths() const { return violated_free_paths_; }

  /// What rows have in common before any of them is known, with the signal of the last fit, noise left out.
  Eigen::MatrixXd covariance(const std::vector<Row>& rows) const;

  static Eigen::Vector3d normal(const Assembly& solids, const Eigen::Vector3d& at);

 private:
  /// Rows side by side: places, normals, and directions of slopes, one in each row.
  struct Table {
    Eigen::MatrixX3d at, normal, along;
    bool slopes = false;
  };
  static Table table_of(const std::vector<Row>& rows);
  Eigen::MatrixXd covariances(const Table& a, const Table& b) const;
  /// Into `out`, whose columns follow each other; `apart` has room for a row a pair, of which the second number is 0.
  void covariances(const Table& a, const Table& b, Points& apart, MatrixOut out) const;
  /// Calls use(first place, count of places, their covariances with the rows), until all places had their turn.
  template <class Use>
  void for_blocks(const Places& places, const Use& use) const;

  using Lower = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Rows that were taken in, those of free ways last.
  struct Known {
    std::vector<Row> rows;
    Table table;
    Lower lower;  ///< the Cholesky factor of the covariance of the others, noise included
    Eigen::VectorXd weights;
  };
  /// With as much jitter as it takes, and as many rows as it allows.
  void take_in(std::vector<Row> rows);
  std::vector<Row> contacts_of(const Assembly& solids, const std::vector<SurfaceTouch>& touches) const;
  struct Passage;
  /// The points of free ways near or in the assembly.
  std::vector<Passage> passages(const Assembly& solids, const std::vector<SurfaceTouch>& touches) const;
  void look_at(const std::vector<Passage*>& passages) const;
  /// Of each stretch of a way that was inside the surface the deepest point; one that was taken ends a stretch.
  std::vector<Passage*> deepest(const std::vector<Passage*>& passages) const;
  /// Adds what holds of these to the contacts, in the optimum.
  void keep_free(std::vector<Passage> passages);
  /// That of a contact, but no way is known better than by a tenth of a millimetre: that keeps the problem far from
  /// singular, however many points hold side by side.
  double noise_of_ways() const;

  std::shared_ptr<const Kernel> kernel_;
  ResidualGpSettings settings_;
  double unit_ = 1.0;  ///< variance of the kernel
  double signal_ = 0.0;
  Known known_;
  std::vector<Row> free_;
  FactorReport report_;
  int violated_free_paths_ = 0;
};

}  // namespace palpate
