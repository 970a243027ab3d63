// SPDX-License-Identifier: MIT
// Arrays of numbers compared as a whole.
#pragma once

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cstring>

namespace palpate::test {

/// The largest difference of two arrays of one shape; 0 if they are empty.
inline double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.size() == 0 ? 0.0 : (a - b).cwiseAbs().maxCoeff();
}

inline bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// What `write` puts into a matrix of this size that lies inside a larger one. Fails the test where it writes beside.
template <class Write>
Eigen::MatrixXd written_inside(Eigen::Index rows, Eigen::Index columns, const Write& write) {
  constexpr double kUntouched = 7.25;
  Eigen::MatrixXd around = Eigen::MatrixXd::Constant(rows + 4, columns + 2, kUntouched);
  Eigen::Ref<Eigen::MatrixXd> inside = around.block(2, 1, rows, columns);
  write(inside);
  Eigen::MatrixXd out = inside;
  inside.setConstant(kUntouched);
  EXPECT_TRUE((around.array() == kUntouched).all()) << "something was written beside the output";
  return out;
}

}  // namespace palpate::test
