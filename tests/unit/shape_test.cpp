// SPDX-License-Identifier: MIT
// Every primitive, upright and tilted, against its definition as a set of points and as triangles.
#include "support/filled.hpp"
#include "support/sanitizers.hpp"
#include "support/shape_cases.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/Geometry>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

struct Pose {
  double tilt;      ///< degrees
  double rotation;  ///< degrees
};

const Pose kPoses[] = {{0, 0}, {0, 37}, {25, 0}, {-40, 110}, {79, -20}};

std::string posed(const ShapeCase& one, const Pose& pose) {
  return with_fields(one.options, "at: [20 cm, 20 cm], tilt: " + std::to_string(pose.tilt) +
                                      " deg, rotation: " + std::to_string(pose.rotation) + " deg");
}

/// From the desk's frame to the shape's, by the order that the options tell: tilted, set down, turned, moved.
struct Frame {
  Eigen::Matrix3d turn;
  double lift;

  Frame(const ShapeCase& one, const Pose& pose)
      // About the axis across, so that the end of the length rises: a negative angle in the right-handed sense.
      : turn(Eigen::AngleAxisd(pose.rotation * kPi / 180, Vector3d::UnitZ()) *
             Eigen::AngleAxisd(-pose.tilt * kPi / 180, Vector3d::UnitY())),
        lift(one.surface().support(turn.transpose() * -Vector3d::UnitZ())) {}

  Vector3d to_shape(double x, double y, double z) const {
    return turn.transpose() * Vector3d(x - 0.2, y - 0.2, z - lift);
  }
};

std::shared_ptr<const Shape> shape_of(const ShapeCase& one) {
  const SceneOptions scene = filled<SceneOptions>("{area: {width: 1 m, depth: 1 m}, objects: [" + one.options + "]}");
  return context_of(shared_host()).create<const Shape>(scene.objects[0].shape);
}

class ShippedShape : public testing::TestWithParam<ShapeCase> {};

TEST_P(ShippedShape, HasTheHeightOfTheHighestPointThatIsInside) {
  // The lift comes from triangles within 3e-6 of the surface; rounding is far below.
  constexpr double kSlack = 5e-6;
  const int places = brief() ? 100 : 300;
  for (const Pose& pose : kPoses) {
    const auto scene = scene_of({posed(GetParam(), pose)});
    const Frame frame(GetParam(), pose);
    Random random(1, "test/primitive");
    int on_object = 0;
    for (int i = 0; i < places; ++i) {
      const double x = 0.12 + 0.16 * random.uniform();
      const double y = 0.12 + 0.16 * random.uniform();
      const double height = scene->height(x, y);
      if (height > 0.0) {
        ++on_object;
        ASSERT_TRUE(GetParam().inside(frame.to_shape(x, y, height), kSlack)) << x << " " << y << " " << height;
      }
      for (double z = height + 1e-4; z < 0.13; z += 2e-4) {
        ASSERT_FALSE(GetParam().inside(frame.to_shape(x, y, z), -kSlack)) << x << " " << y << " " << z;
      }
    }
    EXPECT_GT(on_object, places / 20) << pose.tilt;
    EXPECT_NEAR(scene->highest(), GetParam().surface().support(frame.turn.transpose() * Vector3d::UnitZ()) + frame.lift,
                4e-6);
  }
}

TEST_P(ShippedShape, ReachesAsFarAsItsTriangles) {
  const auto shape = shape_of(GetParam());
  const Surface triangles = GetParam().surface();
  Random random(2, "test/primitive");
  for (int i = 0; i < 500; ++i) {
    const Vector3d direction = random_direction(random);
    EXPECT_NEAR(shape->support(direction), triangles.support(direction), 3e-6) << direction.transpose();
  }
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    EXPECT_NEAR(shape->support(axis), triangles.support(axis), 3e-6) << axis.transpose();
  }
}

TEST_P(ShippedShape, KeepsTheLawsOfShapes) { check_shape_laws(*shape_of(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Every, ShippedShape, testing::ValuesIn(shape_cases()),
                         [](const auto& one) { return one.param.name; });

TEST(ShapeByHand, HasItsClosedForm) {
  const auto at = [](const std::string& object, double s, double t) {
    return scene_of({with_fields(object, "at: [20 cm, 20 cm]")})->height(0.2 + s, 0.2 + t);
  };
  EXPECT_DOUBLE_EQ(at("{type: block, length: 8 cm, width: 5 cm, height: 3 cm}", 0.0399, -0.0249), 0.03);
  EXPECT_EQ(at("{type: block, length: 8 cm, width: 5 cm, height: 3 cm}", 0.0401, 0), 0.0);
  EXPECT_NEAR(at("{type: dome, diameter: 10 cm, height: 5 cm}", 0.03, 0), 0.04, 1e-15) << "half a ball";
  EXPECT_NEAR(at("{type: cylinder, diameter: 6 cm, height: 4 cm}", 0.0, 0.0299), 0.04, 1e-15);
  EXPECT_NEAR(at("{type: cone, diameter: 8 cm, height: 5 cm}", 0.0, 0.0), 0.05, 1e-15) << "the apex";
  EXPECT_NEAR(at("{type: cone, diameter: 8 cm, height: 5 cm}", 0.03, 0.0), 0.0125, 1e-15);
  EXPECT_NEAR(at("{type: ellipsoid, length: 10 cm, width: 6 cm, height: 4 cm}", 0.03, 0.0), 0.02 * 1.8, 1e-15);
  EXPECT_NEAR(at("{type: ring, outer: 10 cm, inner: 6 cm, height: 2 cm}", 0.04, 0.0), 0.02, 1e-15);
  EXPECT_EQ(at("{type: ring, outer: 10 cm, inner: 6 cm, height: 2 cm}", 0.0, 0.0), 0.0) << "through the hole";
}

TEST(ShapeByHand, LiesOnItsSlantWhenABlockIsTilted) {
  // A block 10 cm long and 1 cm high, lifted by 30 degrees: over the middle its top is at 5 cm * sin + 1 cm / cos.
  const auto scene =
      scene_of({"{type: block, length: 10 cm, width: 4 cm, height: 1 cm, tilt: 30 deg, at: [20 cm, 20 cm]}"});
  EXPECT_NEAR(scene->height(0.2, 0.2), 0.025 + 0.01 / std::cos(kPi / 6), 1e-15);
  EXPECT_NEAR(scene->height(0.22, 0.2) - scene->height(0.2, 0.2), 0.02 * std::tan(kPi / 6), 1e-15) << "+x is lifted";
  EXPECT_NEAR(scene->highest(), 0.05 + 0.01 * std::cos(kPi / 6), 1e-15);
}

}  // namespace
}  // namespace palpate::test
