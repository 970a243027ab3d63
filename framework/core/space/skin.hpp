// SPDX-License-Identifier: MIT
// By how much the surface is off the simple solids: a Gaussian process over the signed distance whose mean is theirs.
//
//     f(x) = m(x) - g(x),   g ~ GP(0, s^2 k(|x - x'|) (1 + n(x) . n(x')) / 2)
//
// m is the distance to the composition, n its gradient of unit length; the surface is where f is 0. The factor of the
// normals, a linear kernel, keeps what is learnt of one side of a thin wall from the other.
#pragma once

#include "space/solids.hpp"

#include <palpate/kernel.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <memory>
#include <utility>
#include <vector>

namespace palpate {

struct SkinSettings {
  double most = 0.006;    ///< largest signal, metres: it is that of the touches, if that is less
  double noise = 0.0005;  ///< of a contact, metres
};

class Skin {
 public:
  /// The kernel is asked for places on the desk, as far apart as those in space: it has to be one of the distance
  /// alone.
  Skin(std::shared_ptr<const Kernel> kernel, const SkinSettings& settings)
      : kernel_(std::move(kernel)), settings_(settings) {}

  /// The process over `solids`, which must outlive it, after these touches.
  void fit(const Composition& solids, const std::vector<SurfaceTouch>& touches);

  struct Place {
    Eigen::Vector3d at, normal;
  };
  /// By how much the surface lies outside the composition's, near such a place of it, metres.
  double mean(const Place& place) const;
  double variance(const Place& place) const;
  double signal() const { return signal_; }

  static Eigen::Vector3d normal(const Composition& solids, const Eigen::Vector3d& at);

 private:
  /// Of a place with each of the touches.
  Eigen::VectorXd covariances(const Place& place, std::size_t count) const;

  std::shared_ptr<const Kernel> kernel_;
  SkinSettings settings_;
  double signal_ = 0.0;
  std::vector<Place> places_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;
};

}  // namespace palpate
