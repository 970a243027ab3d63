// SPDX-License-Identifier: MIT
// The process over space: what many places cost and say, free ways, normals that are felt, and what it does of data
// that no surface has. That its numbers are right to many digits is for tests/stability/residual_gp_test.cpp.
#include "solids/residual_gp.hpp"

#include "support/mocks.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr const char* kFourCentimetres = "{length_scale: 4 cm}";

std::shared_ptr<Kernel> kernel_of(const std::string& type = "matern32", const std::string& options = kFourCentimetres) {
  return make<Kernel>(shared_host(), type, options);
}

Assembly of(const Primitive& primitive) {
  Assembly out;
  out.parts.push_back({primitive, {}, {}, 0.0});
  return out;
}

Assembly ball() {
  return of({Primitive::Form::ellipsoid, {0, 0, 0.05}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.05}, 0.0});
}

/// Its front is at y = 0.
Assembly plate() {
  return of({Primitive::Form::box, {0, -0.05, 0.1}, Eigen::Matrix3d::Identity(), {0.1, 0.05, 0.1}, 0.0});
}

/// From the front, as far as y.
SurfaceTouch onto_plate(double x, double y) { return {{{x, 0.2, 0.1}, {0, -1, 0}}, 0.2 - y, true, false}; }

ResidualGp::Place on_plate(double x) { return {{x, 0.0, 0.1}, {0, 1, 0}}; }

SurfaceTouch onto_ball(const Vector3d& out, double off) {
  return {{Vector3d(0, 0, 0.05) + (0.15 + off) * out, -out}, 0.1, true, false};
}

ResidualGp::Place on_ball(const Vector3d& out) { return {Vector3d(0, 0, 0.05) + 0.05 * out, out}; }

ResidualGp::Places all_over_the_ball(int count) {
  Random random(3, "test/skin");
  ResidualGp::Places out;
  for (int i = 0; i < count; ++i) out.push_back(on_ball(random_direction(random)));
  return out;
}

TEST(ResidualGpOfMany, SaysOfEachWhatItSaysOfOne) {
  const Assembly solids = ball();
  Random random(1, "test/skin");
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 40; ++i) touches.push_back(onto_ball(random_direction(random), 0.003 * random.uniform()));
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, touches);
  const ResidualGp::Places places = all_over_the_ball(600);
  const Eigen::VectorXd means = residual_gp.means(places);
  const ResidualGp::Posterior all = residual_gp.posterior(places);
  ASSERT_EQ(all.variance.size(), 600);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(means(k), residual_gp.mean(places[i]), 1e-15);
    EXPECT_NEAR(all.mean(k), means(k), 1e-15);
    EXPECT_NEAR(all.variance(k), residual_gp.posterior({places[i]}).variance(0), 1e-17);
  }
  EXPECT_EQ(all.clamped, 0);
  EXPECT_EQ(residual_gp.means({}).size(), 0);
}

TEST(ResidualGpOfAPlate, KeepsWhatIsLearntOfOneSideOfAWallFromTheOther) {
  Assembly plate;
  plate.parts.push_back(
      {{Primitive::Form::box, {0, 0, 0.1}, Eigen::Matrix3d::Identity(), {0.1, 0.002, 0.1}, 0.0}, {}, {}, 0.0});
  ResidualGp residual_gp(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005});
  residual_gp.fit(plate, {{{{0, 0.2, 0.1}, {0, -1, 0}}, 0.195, true, false}});  // 3 mm in front of it
  EXPECT_NEAR(residual_gp.mean({{0, 0.002, 0.1}, {0, 1, 0}}), 0.003, 2e-4);
  EXPECT_NEAR(residual_gp.mean({{0, -0.002, 0.1}, {0, -1, 0}}), 0.0, 1e-12);
  EXPECT_NEAR(residual_gp.posterior({{{0, -0.002, 0.1}, {0, -1, 0}}}).variance(0),
              residual_gp.signal() * residual_gp.signal(), 1e-12);
}

TEST(ResidualGpBeforeAnyTouch, IsItsPrior) {
  const Assembly solids = ball();
  ResidualGp residual_gp(kernel_of("scale", "{factor: 4, kernel: {type: matern52, length_scale: 3 cm}}"),
                         {0.006, 0.0005});
  residual_gp.fit(solids, {});
  for (const ResidualGp::Place& place : all_over_the_ball(20)) {
    EXPECT_EQ(residual_gp.mean(place), 0.0);
    EXPECT_EQ(residual_gp.posterior({place}).variance(0), 4 * 0.006 * 0.006);
  }
}

TEST(ResidualGpAndFreeWays, TheSurfaceIsNotWhereAToolHasPassed) {
  const Assembly solids = plate();
  std::vector<SurfaceTouch> touches{onto_plate(-0.03, 0.004), onto_plate(0.03, 0.004)};
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, touches);
  EXPECT_GT(residual_gp.mean(on_plate(0.0)), 0.003);
  EXPECT_TRUE(residual_gp.free_paths().points.empty());
  const double variance = residual_gp.posterior({on_plate(0.0)}).variance(0);

  touches.push_back({{{0.0, 0.001, 0.4}, {0, 0, -1}}, 0.39, false, false});  // down along it, 1 mm in front
  residual_gp.fit(solids, touches);
  EXPECT_FALSE(residual_gp.free_paths().points.empty());
  EXPECT_LT(residual_gp.mean(on_plate(0.0)), 0.0015);
  EXPECT_NEAR(residual_gp.posterior({on_plate(0.0)}).variance(0), variance,
              1e-18);  // which says nothing of where it is
  for (const double x : {-0.03, 0.03}) EXPECT_NEAR(residual_gp.mean(on_plate(x)), 0.004, 0.0008);
}

TEST(ResidualGpAndFreeWays, OneDeepInTheSolidsIsForTheSolidsToExplain) {
  const Assembly solids = plate();
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, {onto_plate(0.03, 0.002), {{{0.0, -0.05, 0.4}, {0, 0, -1}}, 0.39, false, false}});
  EXPECT_TRUE(residual_gp.free_paths().points.empty());
}

/// Down along the plate's front, so far inside.
SurfaceTouch along_plate(double x, double inside) { return {{{x, -inside, 0.4}, {0, 0, -1}}, 0.39, false, false}; }

TEST(ResidualGpAndFreeWays, MayPushAsFarAsThreeStandardDeviationsOfTheKernelToo) {
  const Assembly solids = plate();
  const std::vector<SurfaceTouch> touches{onto_plate(-0.09, 0.001), onto_plate(0.09, -0.001), along_plate(0.0, 0.005)};
  ResidualGp plain(kernel_of(), {0.006, 0.0005});
  plain.fit(solids, touches);
  EXPECT_TRUE(plain.free_paths().points.empty());
  ResidualGp scaled(kernel_of("scale", "{factor: 9, kernel: {type: matern32, length_scale: 4 cm}}"), {0.006, 0.0005});
  scaled.fit(solids, touches);
  EXPECT_DOUBLE_EQ(scaled.signal(), 0.001);
  EXPECT_NEAR(scaled.deviation(), 0.003, 1e-15);
  EXPECT_FALSE(scaled.free_paths().points.empty());
  EXPECT_LT(scaled.mean(on_plate(0.0)), -0.004);
}

TEST(ResidualGpAndFreeWays, TheSurfaceReachesAsFarAsTheyPushIt) {
  const Assembly solids = plate();
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, {onto_plate(-0.09, 0.002), onto_plate(0.09, -0.002)});
  EXPECT_GE(residual_gp.reach(), 0.0018);
  EXPECT_LT(residual_gp.reach(), 0.0031);
  residual_gp.fit(solids, {onto_plate(-0.09, 0.002), onto_plate(0.09, -0.002), along_plate(0.0, 0.005)});
  double farthest = 0.0;
  for (double x = -0.1; x < 0.1; x += 0.002) farthest = std::max(farthest, std::abs(residual_gp.mean(on_plate(x))));
  EXPECT_GT(farthest, 0.004);
  EXPECT_GE(residual_gp.reach(), farthest);
}

TEST(ResidualGpAndFreeWays, WithoutNoiseTheyAskForNoJitter) {
  const Assembly solids = plate();
  std::vector<SurfaceTouch> touches{onto_plate(-0.05, 0.004), onto_plate(0.05, 0.004)};
  for (int i = 0; i < 30; ++i) touches.push_back(along_plate(1e-9 * i, -0.001));
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0});
  residual_gp.fit(solids, touches);
  EXPECT_GT(residual_gp.rows().size(), 30U);
  EXPECT_EQ(residual_gp.report().jitter, 0.0);
  EXPECT_EQ(residual_gp.report().redundant_taps, 0);
  EXPECT_EQ(residual_gp.free_paths().violated, 0);
  EXPECT_NEAR(residual_gp.mean(on_plate(0.0)), 0.001, 1e-4);  // no way is known better
}

TEST(ResidualGpAndNormals, TheSurfaceIsTurnedAsTheToolFelt) {
  const Assembly solids = plate();
  const double angle = 0.1;
  SurfaceTouch touch = onto_plate(0.0, 0.001);
  touch.normal = Vector3d(std::sin(angle), std::cos(angle), 0.0);
  for (const char* type : {"matern32", "matern52", "rbf"}) {
    ResidualGp residual_gp(kernel_of(type), {0.006, 1e-5, 1e-4});
    residual_gp.fit(solids, {touch});
    ASSERT_EQ(residual_gp.rows().size(), 3U);
    // f = y - g(x, z): its gradient is (-dg/dx, 1, -dg/dz).
    const double step = 1e-4;
    const auto beside = [](double x) { return ResidualGp::Place{{x, 0.001, 0.1}, {0, 1, 0}}; };
    const double slope = (residual_gp.mean(beside(step)) - residual_gp.mean(beside(-step))) / (2 * step);
    EXPECT_NEAR(slope, -std::tan(angle), 0.002) << type;
    EXPECT_NEAR(residual_gp.mean(on_plate(0.0)), 0.001, 1e-4);
    // Beside it, less is left unknown than without.
    ResidualGp without(kernel_of(type), {0.006, 1e-5, 1e-4});
    touch.normal.reset();
    without.fit(solids, {touch});
    EXPECT_LT(residual_gp.posterior({on_plate(0.01)}).variance(0),
              0.8 * without.posterior({on_plate(0.01)}).variance(0));
    touch.normal = Vector3d(std::sin(angle), std::cos(angle), 0.0);
  }
}

TEST(ResidualGpAndNormals, OneOfAnotherSurfaceThanTheSolidsHaveIsLeftOut) {
  const Assembly solids = plate();
  SurfaceTouch touch = onto_plate(0.0, 0.001);
  touch.normal = Vector3d(1, 0, 0);
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, {touch});
  EXPECT_EQ(residual_gp.rows().size(), 1U);
}

std::string refusal_of_kernel(const std::string& type, const std::string& options) {
  return error_of([&] { ResidualGp(kernel_of(type, options), {0.006, 0.0005}); });
}

TEST(ResidualGpAndKernels, ThoseThatAreNotOfTheDistanceAloneAreRefused) {
  const char* const line =
      "kernel: depends on more than the distance, but surface: implicit needs a kernel of the distance alone, choose "
      "one with a single length "
      "scale, such as matern32";
  EXPECT_EQ(refusal_of_kernel("rbf", "{length_scale: 3 cm, length_scale_y: 2.9 cm}"), line);
  EXPECT_EQ(refusal_of_kernel("product",
                              "{kernels: [{type: rbf, length_scale: 1 mm, length_scale_y: 9 m}, {type: matern32}]}"),
            line);
  EXPECT_EQ(
      refusal_of_kernel("sum", "{kernels: [{type: rbf}, {type: matern52, length_scale: 2 cm, length_scale_y: 4 cm}]}"),
      line);
  for (const char* type : {"matern12", "matern32", "matern52", "rbf", "rational_quadratic"}) {
    for (const char* length : {"1 um", "1 mm", "4 cm", "10 m"})
      EXPECT_EQ(refusal_of_kernel(type, std::string("{length_scale: ") + length + "}"), "accepted") << type << length;
  }
  EXPECT_EQ(refusal_of_kernel("scale", "{factor: 3, kernel: {type: rbf}}"), "accepted");
  EXPECT_EQ(refusal_of_kernel("sum", "{kernels: [{type: rbf}, {type: matern12}]}"), "accepted");
  EXPECT_EQ(refusal_of_kernel("product", "{kernels: [{type: matern32, length_scale: 1 mm}, {type: matern32}]}"),
            "accepted");
}

TEST(ResidualGpAndKernels, NormalsAreRefusedWhereTheKernelHasNoSlopes) {
  const Assembly solids = plate();
  SurfaceTouch touch = onto_plate(0.0, 0.001);
  touch.normal = Vector3d(0, 1, 0);
  for (const char* type : {"matern12", "rational_quadratic"}) {
    ResidualGp residual_gp(kernel_of(type), {0.006, 0.0005});
    EXPECT_EQ(error_of([&] { residual_gp.fit(solids, {touch}); }),
              "kernel: is not differentiable everywhere, but measured surface normals need its derivatives, choose "
              "matern32, matern52 or rbf");
  }
}

/// That nothing is NaN, and no variance beyond the prior.
void expect_sound(const ResidualGp& residual_gp) {
  const ResidualGp::Posterior all = residual_gp.posterior(all_over_the_ball(300));
  EXPECT_TRUE(all.mean.allFinite());
  EXPECT_LE(all.mean.cwiseAbs().maxCoeff(), 0.1);
  EXPECT_GE(all.variance.minCoeff(), 0.0);
  EXPECT_LE(all.variance.maxCoeff(), residual_gp.signal() * residual_gp.signal());
}

TEST(ResidualGpOfHardData, TheSameContactAHundredTimesIsOneOfLessNoise) {
  const Assembly solids = ball();
  const SurfaceTouch touch = onto_ball({1, 0, 0}, 0.002);
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, std::vector<SurfaceTouch>(100, touch));
  const double signal = 0.002 * 0.002;
  const double noise = 0.0005 * 0.0005 / 100;
  EXPECT_NEAR(residual_gp.mean(on_ball({1, 0, 0})), 0.002 * signal / (signal + noise), 2e-5);
  EXPECT_EQ(residual_gp.report().raised, 0);
  expect_sound(residual_gp);
}

TEST(ResidualGpOfHardData, WithoutNoiseDuplicatesRaiseTheJitterWhichIsCounted) {
  const Assembly solids = ball();
  std::vector<SurfaceTouch> touches(100, onto_ball({1, 0, 0}, 0.002));
  touches.push_back(onto_ball({0, 1, 0}, -0.001));
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0});
  residual_gp.fit(solids, touches);
  EXPECT_GT(residual_gp.report().raised, 0);
  EXPECT_GT(residual_gp.report().jitter, 0.0);
  EXPECT_LE(residual_gp.report().jitter, 1e-11);
  EXPECT_NEAR(residual_gp.mean({{0.052, 0, 0.05}, {1, 0, 0}}), 0.002, 1e-6);
  expect_sound(residual_gp);
}

TEST(ResidualGpOfHardData, ContactsThatContradictEachOtherSettleBetween) {
  const Assembly solids = ball();
  for (const double noise : {0.0005, 1e-6, 0.0}) {
    std::vector<SurfaceTouch> touches{onto_ball({1, 0, 0}, 0.003), onto_ball({1, 0, 0}, 0.003)};
    touches[1].line.origin += Vector3d(0.0, 1e-9, 0.0);
    touches[1].length += 0.002;  // 2 mm deeper, 1e-9 m beside
    touches.push_back(onto_ball({1, 0, 0}, 0.001 + 1e-9));
    touches.back().line.origin.z() += 1e-9;
    ResidualGp residual_gp(kernel_of(), {0.006, noise});
    residual_gp.fit(solids, touches);
    expect_sound(residual_gp);
  }
}

TEST(ResidualGpOfHardData, AFreeWayThroughAContactLeavesTheSurfaceBetween) {
  const Assembly solids = plate();
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  std::vector<SurfaceTouch> touches{onto_plate(0.0, 0.004)};
  for (int i = 0; i < 20; ++i) touches.push_back({{{0.0, 0.002, 0.4}, {0, 0, -1}}, 0.39, false, false});
  residual_gp.fit(solids, touches);
  const ResidualGp::Place on_the_way{{0.0, 0.002, 0.1}, {0, 1, 0}};
  EXPECT_GT(residual_gp.mean(on_the_way), 0.0019);
  EXPECT_LT(residual_gp.mean(on_the_way), 0.0025);
  for (const double noise : {1e-6, 0.0}) {
    ResidualGp strict(kernel_of(), {0.006, noise});
    strict.fit(solids, touches);
    EXPECT_TRUE(std::isfinite(strict.mean(on_plate(0.0))));
    EXPECT_GE(strict.posterior({on_plate(0.0)}).variance(0), 0.0);
  }
}

/// Alike within 5 cm and not at all beyond: no two can be so to a third, and not to each other.
std::shared_ptr<Kernel> kernel_of_no_covariance() {
  return std::make_shared<FormulaKernel>(
      [](const FormulaKernel::Place& a, const FormulaKernel::Place& b) { return (a - b).norm() < 0.05 ? 1.0 : 0.0; });
}

std::vector<SurfaceTouch> sixty_around_the_ball() {
  Random random(7, "test/skin");
  std::vector<SurfaceTouch> out;
  for (int i = 0; i < 60; ++i) {
    const double off = 0.004 * random.uniform();
    out.push_back(onto_ball(random_direction(random), off));
  }
  return out;
}

TEST(ResidualGpOfHardData, WhereTheKernelIsNotPositiveDefiniteRowsAreSetAsideAndCounted) {
  const Assembly solids = ball();
  std::vector<SurfaceTouch> touches = sixty_around_the_ball();
  ResidualGp residual_gp(kernel_of_no_covariance(), {0.006, 0.0});
  touches.push_back({{{0.0, 0.05, 0.3}, {0, 0, -1}}, 0.29, false, false});  // which grazes it
  residual_gp.fit(solids, touches);
  EXPECT_FALSE(residual_gp.free_paths().points.empty());
  std::size_t contacts = 0;
  for (const ResidualGp::ResidualDatum& row : residual_gp.rows()) contacts += row.free ? 0 : 1;
  EXPECT_GE(static_cast<std::size_t>(residual_gp.report().redundant_taps), 60 - contacts);
  EXPECT_GT(residual_gp.report().pivoted, 0);
  EXPECT_GT(residual_gp.report().redundant_taps, 0);
  EXPECT_GT(residual_gp.rows().size(), 0U);
  const ResidualGp::Posterior all = residual_gp.posterior(all_over_the_ball(300));
  EXPECT_TRUE(all.mean.allFinite());
  EXPECT_GE(all.variance.minCoeff(), 0.0);
  EXPECT_GT(all.clamped, 0);
}

TEST(ResidualGpOfHardData, FreeWaysTakeNothingFromContactsWhereTheKernelIsNotPositiveDefinite) {
  const Assembly solids = ball();
  std::vector<SurfaceTouch> touches = sixty_around_the_ball();
  ResidualGp residual_gp(kernel_of_no_covariance(), {0.006, 0.0});
  const auto contacts = [&] {
    return std::count_if(residual_gp.rows().begin(), residual_gp.rows().end(),
                         [](const ResidualGp::ResidualDatum& row) { return !row.free; });
  };
  residual_gp.fit(solids, touches);
  const auto before = contacts();
  const ResidualGp::Places places = all_over_the_ball(100);
  const ResidualGp::Posterior without = residual_gp.posterior(places);
  for (int i = 0; i < 6; ++i) {  // which graze it
    const Vector3d out(std::cos(i), std::sin(i), 0.0);
    touches.push_back({{Vector3d(0.05 * out + Vector3d(0, 0, 0.3)), {0, 0, -1}}, 0.29, false, false});
  }
  residual_gp.fit(solids, touches);
  EXPECT_FALSE(residual_gp.free_paths().points.empty());
  EXPECT_EQ(contacts(), before);
  const ResidualGp::Posterior with = residual_gp.posterior(places);
  EXPECT_EQ(with.variance, without.variance);
  EXPECT_TRUE(with.mean.allFinite());
}

TEST(ResidualGpOfHardData, TheSameNormalAHundredTimesAndItsOpposite) {
  const Assembly solids = plate();
  SurfaceTouch touch = onto_plate(0.0, 0.001);
  touch.normal = Vector3d(0.1, 1.0, 0.0).normalized();
  std::vector<SurfaceTouch> touches(100, touch);
  touches.push_back(touch);
  touches.back().normal = Vector3d(-0.1, 1.0, 0.0).normalized();
  for (const double noise : {0.02, 0.0}) {
    ResidualGp residual_gp(kernel_of(), {0.006, noise / 40, noise});
    residual_gp.fit(solids, touches);
    EXPECT_EQ(residual_gp.report().raised > 0, noise == 0.0);
    const ResidualGp::Posterior all = residual_gp.posterior({on_plate(-0.01), on_plate(0.0), on_plate(0.01)});
    EXPECT_TRUE(all.mean.allFinite());
    EXPECT_GE(all.variance.minCoeff(), 0.0);
    if (noise > 0.0) {
      EXPECT_GT(all.mean(0), all.mean(2));  // as the hundred have it
    }
  }
}

TEST(ResidualGpOfHardData, ContactsThatAllAreOnTheSolidsLeaveThem) {
  const Assembly solids = ball();
  Random random(6, "test/skin");
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 30; ++i) touches.push_back(onto_ball(random_direction(random), 0.0));
  ResidualGp residual_gp(kernel_of(), {0.006, 0.0005});
  residual_gp.fit(solids, touches);
  EXPECT_EQ(residual_gp.signal(), 0.001);
  for (const ResidualGp::Place& place : all_over_the_ball(50)) EXPECT_NEAR(residual_gp.mean(place), 0.0, 1e-12);
}

}  // namespace
}  // namespace palpate::test
