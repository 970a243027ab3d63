// SPDX-License-Identifier: MIT
// Tests of the simulated arms: against closed forms, against published properties of a real Baxter, and against each
// other.
#include "baxter/body_bench.hpp"
#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/mujoco_arm.hpp"
#include "fake_baxter/series_elastic.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>

namespace palpate::test {
namespace {

using baxter::Joints;
using fake_baxter::Body;
using fake_baxter::BodyOptions;
using fake_baxter::MechanicsOptions;
using Type = MechanicsOptions::Type;

const Eigen::Vector2d kMiddle(0.115, 0.115);

/// Selects an arm and the height of its tip above the desk.
BodyBench::Change with(const MechanicsOptions& mechanics, double above = 0.15) {
  return [=](BodyOptions& out) {
    out.mechanics = mechanics;
    out.speed_ratio = 1.0;  // so that the speed ratio does not limit the joints
    out.start_at = Eigen::Vector3d(kMiddle.x(), kMiddle.y(), above);
  };
}

BodyBench bare(const MechanicsOptions& mechanics, double stiffness = 1500.0, double above = 0.15) {
  return BodyBench(kBare, "{stiffness: {object: " + std::to_string(stiffness) + " N/m}}", with(mechanics, above));
}

const MechanicsOptions kSprings{Type::springs, 0.0, 1e-3};

Joints posture(Random& random) {
  Joints out = baxter::untucked();
  for (double& one : out) one += random.uniform() - 0.5;
  return out;
}

TEST(TheArmWithMasses, EndsWhereTheDriversKinematicsHaveIt) {
  const Eigen::Vector3d tip(0.01, -0.02, 0.15);
  const fake_baxter::Dynamics dynamics(tip);
  const baxter::ArmKinematics arm(tip);
  Random random(1, "test");
  for (int i = 0; i < 100; ++i) {
    const Joints joints = posture(random);
    EXPECT_LT((dynamics.tip(joints) - arm.tip(joints).position).norm(), 1e-12);
    for (int joint = 0; joint < 7; ++joint) {  // central differences
      const Joints little = 1e-5 * Joints::Unit(joint);
      const Eigen::Vector3d way = (arm.tip(joints + little).position - arm.tip(joints - little).position) / 2e-5;
      EXPECT_LT((dynamics.jacobian(joints).col(joint).head<3>() - way).norm(), 1e-9);
    }
  }
}

TEST(TheArmWithMasses, KeepsItsEnergyWhenNothingActsOnItButItsWeight) {
  // Kinetic energy from the inertia, and work of gravity: their sum is constant.
  const fake_baxter::Dynamics dynamics({0, 0, 0.15});
  Random random(2, "test");
  for (int i = 0; i < 20; ++i) {
    Joints joints = posture(random);
    Joints speed;
    for (double& one : speed) one = random.uniform() - 0.5;
    const double begin = 0.5 * speed.dot(dynamics.inertia(joints) * speed);
    double work = 0.0;
    constexpr double kStep = 1e-4;
    for (int step = 0; step < 1000; ++step) {  // midpoint rule
      const Joints before = joints;
      const Joints half = speed + kStep / 2 * dynamics.acceleration(joints, speed, Joints::Zero());
      const Joints middle = joints + kStep / 2 * speed;
      speed += kStep * dynamics.acceleration(middle, half, Joints::Zero());
      joints += kStep * half;
      work -= dynamics.weight(middle).dot(joints - before);
    }
    EXPECT_NEAR(0.5 * speed.dot(dynamics.inertia(joints) * speed) - begin, work, 1e-5);
  }
}

TEST(TheArmWithSprings, SettlesAsFarFromItsSetPointAsARealOneAndStays) {
  BodyBench bench = bare(kSprings);
  bench.hold(3.0);
  const Joints rested = bench.body.joints();
  const double off = (rested - bench.target).cwiseAbs().maxCoeff();
  EXPECT_GT(off, 0.004);
  EXPECT_LT(off, 0.008);
  bench.hold(6.0);
  EXPECT_LT((bench.body.joints() - rested).cwiseAbs().maxCoeff(), 0.0004);
}

TEST(TheArmWithSprings, TrailsItsSetPointInFlightAsARealOne) {
  for (const double speed : {0.12, 0.23, 0.50}) {
    BodyBench bench = bare(kSprings);
    bench.hold(2.0);
    const double rest = (bench.target - bench.body.joints())(1);
    for (int i = 0; i < 150; ++i) {
      bench.target(1) -= speed * Body::kPeriod;
      bench.hold(Body::kPeriod);
    }
    const double lag = (rest - (bench.target - bench.body.joints())(1)) / speed;
    EXPECT_GT(lag, 0.30) << speed;
    EXPECT_LT(lag, 0.42) << speed;
  }
}

/// A touch guarded by the true force: descent until 6 N, then the measured joints.
struct Touch {
  double peak = 0.0;    ///< N
  double depth = 0.0;   ///< m, largest
  double height = 0.0;  ///< m, at the end
  double force = 0.0;   ///< N, at the end
  double felt = 0.0;    ///< N, increase of the measured force
};

Touch touch(const MechanicsOptions& mechanics, double stiffness, double speed) {
  BodyBench bench = bare(mechanics, stiffness, 0.005);
  bench.hold(0.3);
  Touch out;
  const double zero = bench.body.arm().felt.z();
  const auto look = [&] {
    out.peak = std::max(out.peak, bench.body.arm().peak);
    out.depth = std::max(out.depth, bench.body.arm().depth);
  };
  bench.lead({kMiddle.x(), kMiddle.y(), -0.03}, speed, [&] {
    look();
    return bench.body.pressing() > 6.0;
  });
  bench.target = bench.body.joints();
  for (int i = 0; i < 40; ++i) {
    bench.hold(Body::kPeriod);
    look();
  }
  out.height = bench.body.tip().z();
  out.force = bench.body.pressing();
  out.felt = bench.body.arm().felt.z() - zero;
  return out;
}

TEST(TheArmWithSprings, MovesInStepsOfAMillisecondAsInStepsOfATwentieth) {
  const struct {
    double stiffness, speed, friction;
  } cases[] = {{1500, 0.02, 0.0}, {20000, 0.01, 0.4}, {100000, 0.005, 0.0}, {100000, 0.01, 0.4}, {100000, 0.02, 0.0}};
  for (const auto& one : cases) {
    const Touch coarse = touch({Type::springs, one.friction, 1e-3}, one.stiffness, one.speed);
    const Touch fine = touch({Type::springs, one.friction, 5e-5}, one.stiffness, one.speed);
    const std::string where = std::to_string(one.stiffness) + " N/m at " + std::to_string(one.speed) + " m/s";
    EXPECT_NEAR(coarse.peak, fine.peak, 0.01 * fine.peak) << where;
    EXPECT_NEAR(coarse.depth, fine.depth, 0.01 * fine.depth) << where;
    EXPECT_NEAR(coarse.height, fine.height, 0.01 * std::abs(fine.height)) << where;
    EXPECT_GT(fine.peak, 6.0);
    RecordProperty(where, std::to_string(coarse.peak) + " N, " + std::to_string(fine.peak) + " N");
  }
}

class MujocoTwin : public testing::Test {
 protected:
  void SetUp() override {
    if (!fake_baxter::has_mujoco()) GTEST_SKIP() << "MuJoCo is not installed: heading physics of packages.txt";
  }
};

TEST_F(MujocoTwin, HasTheSameWeightAndTheSameLag) {
  BodyBench ours = bare(kSprings);
  BodyBench theirs = bare({Type::mujoco});
  for (BodyBench* bench : {&ours, &theirs}) bench->lead({0.03, 0.2, 0.10}, 0.2);
  // Half of our longer step, at up to 0.7 rad/s.
  EXPECT_LT((ours.body.joints() - theirs.body.joints()).cwiseAbs().maxCoeff(), 4e-4);
  EXPECT_LT((ours.body.arm().felt - theirs.body.arm().felt).cwiseAbs().maxCoeff(), 0.3) << "masses that are moved";
  for (BodyBench* bench : {&ours, &theirs}) bench->hold(3.0);
  EXPECT_LT((ours.body.joints() - theirs.body.joints()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((ours.body.arm().effort - theirs.body.arm().effort).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_F(MujocoTwin, TouchesWithTheSameForces) {
  for (const double friction : {0.0, 0.4}) {
    for (const double stiffness : {1500.0, 20000.0, 100000.0}) {
      for (const double speed : {0.005, 0.01}) {
        const Touch ours = touch({Type::springs, friction, 1e-3}, stiffness, speed);
        const Touch theirs = touch({Type::mujoco, friction, 0.0}, stiffness, speed);
        const std::string where = std::to_string(stiffness) + " N/m at " + std::to_string(speed) + " m/s, " +
                                  std::to_string(friction) + " Nm";
        // MuJoCo's friction and contact yield slightly.
        EXPECT_NEAR(ours.peak, theirs.peak, 0.03 * theirs.peak) << where;
        EXPECT_NEAR(ours.depth, theirs.depth, 0.03 * theirs.depth) << where;
        EXPECT_NEAR(ours.force, theirs.force, 0.03 * theirs.force) << where;
        EXPECT_NEAR(ours.felt, theirs.felt, 0.3) << where;
        EXPECT_NEAR(ours.height, theirs.height, 2e-5 + 0.03 * std::abs(theirs.height)) << where;
      }
    }
  }
}

TEST_F(MujocoTwin, MeetsNothingWhereItPassesTheEdgeOfAnObject) {
  BodyBench bench(kObjectI, "{stiffness: {object: 1500 N/m}}", with({Type::mujoco}, 0.135));
  double peak = 0.0;
  const auto look = [&] {
    peak = std::max(peak, bench.body.arm().peak);
    return false;
  };
  bench.lead({0.03, 0.115, 0.135}, 0.15, look);
  bench.lead({0.2, 0.115, 0.135}, 0.15, look);
  EXPECT_LT(bench.body.tip().x(), 0.19);
  EXPECT_EQ(peak, 0.0);
}

}  // namespace
}  // namespace palpate::test
