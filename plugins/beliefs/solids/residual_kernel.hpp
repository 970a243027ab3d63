// SPDX-License-Identifier: MIT
// The prior covariance of the residual GP, between values and slopes at places in space.
#pragma once

#include "gp/aligned_matrices.hpp"
#include "gp/vector_loops.hpp"

#include <palpate/kernel.hpp>
#include <palpate/types.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace palpate {

class ResidualKernel {
 public:
  /// Evaluates the kernel at points of the desk that have the same distance as the points in space. Throws Error unless
  /// the kernel depends on the distance alone.
  explicit ResidualKernel(std::shared_ptr<const Kernel> kernel);

  struct Place {
    Eigen::Vector3d at, normal;
  };
  using Places = std::vector<Place>;

  /// A datum: the value of g or, if `along` is not 0, its slope in that direction.
  struct ResidualDatum {
    Place place;
    Eigen::Vector3d along = Eigen::Vector3d::Zero();
    double target = 0.0;
    double noise = 0.0;  ///< standard deviation
    bool free = false;   ///< a point of a free path
  };

  /// Rows as matrices: the places, normals and directions of slopes, one row per datum.
  struct DatumTable {
    Eigen::MatrixX3d at, normal, along;
    bool slopes = false;
  };
  static DatumTable table_of(const std::vector<ResidualDatum>& rows);

  bool has_gradient() const { return kernel_->has_gradient(); }
  void set_signal(double signal) { signal_ = signal; }
  double signal() const { return signal_; }
  /// Returns the prior standard deviation of g, metres.
  double deviation() const { return signal_ * std::sqrt(unit_); }

  /// Returns the prior covariances of g.
  Eigen::MatrixXd covariances(const DatumTable& a, const DatumTable& b) const;
  /// Calls use(index of the first place, number of places, their covariances with the table) for blocks of places.
  template <class Use>
  void for_blocks(const Places& places, const DatumTable& table, const Use& use) const;

 private:
  /// Writes the covariances to `out`, whose columns must be contiguous. `apart` is scratch space with one row per pair;
  /// its second column must be 0.
  void covariances(const DatumTable& a, const DatumTable& b, Points& apart, MatrixOut out) const;

  std::shared_ptr<const Kernel> kernel_;
  double unit_ = 1.0;  ///< variance of the kernel
  double signal_ = 0.0;
};

template <class Use>
void ResidualKernel::for_blocks(const Places& places, const DatumTable& table, const Use& use) const {
  const Eigen::Index n = table.at.rows();
  loops::AlignedArray numbers(static_cast<std::size_t>(n * loops::kBlock));
  const Eigen::Map<Eigen::MatrixXd> rows(numbers.data(), loops::kBlock, n);
  Points apart = Points::Zero(n * loops::kBlock, 2);
  for (std::size_t first = 0; first < places.size(); first += loops::kBlock) {
    std::vector<ResidualDatum> some;
    for (std::size_t i = first; i < first + loops::kBlock; ++i)  // repeats the last place if the block is not full
      some.push_back({places[std::min(i, places.size() - 1)]});
    covariances(table_of(some), table, apart, rows);
    const std::size_t count = std::min<std::size_t>(loops::kBlock, places.size() - first);
    use(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count), rows);
  }
}

}  // namespace palpate
