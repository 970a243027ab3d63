// SPDX-License-Identifier: MIT
// The skin against its formula, written out in long double.
#include "space/skin.hpp"

#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/Cholesky>

#include <memory>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

TEST(Skin, IsTheGaussianProcessOfItsFormula) {
  Composition ball;
  ball.parts.push_back(
      {{Piece::Form::ellipsoid, {0, 0, 0.05}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.05}, 0.0}, {}, {}, 0.0});
  Random random(6, "test/skin");
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 12; ++i) {
    const Vector3d out = random_direction(random);
    const Vector3d at = Vector3d(0, 0, 0.05) + (0.05 + 0.003 * random.uniform()) * out;
    touches.push_back({{at + 0.1 * out, -out}, 0.1, true, false});
  }
  const std::shared_ptr<Kernel> kernel = make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}");
  const SkinSettings settings{0.006, 0.0005};
  Skin skin(kernel, settings);
  skin.fit(ball, touches);

  using Real = long double;
  const auto normal = [](const Vector3d& at) { return Vector3d((at - Vector3d(0, 0, 0.05)).normalized()); };
  const Real signal = skin.signal();
  const auto covariance = [&](const Vector3d& a, const Vector3d& b) {
    const Real r = std::sqrt(Real(3)) * Real((a - b).norm()) / Real(0.04);
    return signal * signal * (1 + r) * std::exp(-r) * (1 + Real(normal(a).dot(normal(b)))) / 2;
  };
  const auto n = static_cast<Eigen::Index>(touches.size());
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> k(n, n);
  Eigen::Matrix<Real, Eigen::Dynamic, 1> off(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d at = touches[static_cast<std::size_t>(i)].end();
    off(i) = Real((at - Vector3d(0, 0, 0.05)).norm()) - Real(0.05);
    for (Eigen::Index j = 0; j < n; ++j) k(i, j) = covariance(at, touches[static_cast<std::size_t>(j)].end());
    k(i, i) += Real(0.0005) * Real(0.0005);
  }
  for (int i = 0; i < 50; ++i) {
    const Vector3d out = random_direction(random);
    const Vector3d at = Vector3d(0, 0, 0.05) + 0.05 * out;
    Eigen::Matrix<Real, Eigen::Dynamic, 1> with(n);
    for (Eigen::Index j = 0; j < n; ++j) with(j) = covariance(at, touches[static_cast<std::size_t>(j)].end());
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> solved = k.ldlt().solve(with);
    EXPECT_NEAR(skin.mean({at, out}), static_cast<double>(solved.dot(off)), 1e-9);
    EXPECT_NEAR(skin.variance({at, out}), static_cast<double>(signal * signal - solved.dot(with)), 1e-12);
  }
}

TEST(Skin, KeepsWhatIsLearntOfOneSideOfAWallFromTheOther) {
  Composition plate;
  plate.parts.push_back(
      {{Piece::Form::box, {0, 0, 0.1}, Eigen::Matrix3d::Identity(), {0.1, 0.002, 0.1}, 0.0}, {}, {}, 0.0});
  Skin skin(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005});
  skin.fit(plate, {{{{0, 0.2, 0.1}, {0, -1, 0}}, 0.195, true, false}});  // 3 mm in front of it
  EXPECT_NEAR(skin.mean({{0, 0.002, 0.1}, {0, 1, 0}}), 0.003, 2e-4);
  EXPECT_NEAR(skin.mean({{0, -0.002, 0.1}, {0, -1, 0}}), 0.0, 1e-12);
  EXPECT_NEAR(skin.variance({{0, -0.002, 0.1}, {0, -1, 0}}), skin.signal() * skin.signal(), 1e-12);
}

}  // namespace
}  // namespace palpate::test
