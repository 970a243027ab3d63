// SPDX-License-Identifier: MIT
// The search of what simple solids stand there, and what it sums up.
#include "solids/assembly_sampler.hpp"

#include "solids/cloud_distances.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

/// 10 x 6 x 6 cm, on the desk in the middle of an area of 26 cm.
const Primitive kStanding{
    Primitive::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};

TEST(AssemblySampler, FindABoxFromTouchesOfIt) {
  Random random(7, "test/solids");
  AssemblySamplerSettings settings;
  settings.count = 12;
  settings.moves = 200;
  AssemblySampler solids({0.26, 0.26}, settings, Random(7, "solids"));
  for (int i = 0; i < 60; ++i) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Vector3d through = kStanding.centre + 0.06 * random.uniform() * random_direction(random);
    const Line line{through - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    const double hit = std::min(kStanding.first_intersection(line), desk);
    solids.add({{line, hit, true, hit == desk}});
  }
  const Assembly& best = solids.best();
  EXPECT_TRUE(std::isfinite(best.posterior()));
  const LineBundle bundle(kStanding.centre, 0.12, 60, 0.01);
  Cloud truth, believed;
  for (const Line& line : bundle.lines) {
    const double desk = line.direction.z() < 0 ? -line.origin.z() / line.direction.z() : kNoHit;
    if (kStanding.first_intersection(line) < desk)
      truth.push_back(line.origin + kStanding.first_intersection(line) * line.direction);
    if (best.first_intersection(line) < desk)
      believed.push_back(line.origin + best.first_intersection(line) * line.direction);
  }
  EXPECT_GT(compare_clouds(thinned(believed, 0.003), thinned(truth, 0.003)).f_score, 0.95);
}

/// What a camera would see of a primitive on the desk, as touches.
std::vector<SurfaceTouch> seen(const Primitive& primitive) {
  std::vector<SurfaceTouch> out;
  const Vector3d eye(0.6, 0.13, 0.4);
  for (int i = 0; i < 13; ++i) {
    for (int j = 0; j < 13; ++j) {
      const Vector3d at(0.13, 0.13 + 0.02 * (i - 6), 0.03 + 0.015 * (j - 6));
      const Line line{eye, (at - eye).normalized()};
      const double desk = line.direction.z() < 0 ? -eye.z() / line.direction.z() : kNoHit;
      const double hit = primitive.first_intersection(line);
      out.push_back({line, std::min({hit, desk, 1.0}), std::min(hit, desk) < 1.0, desk <= hit});
    }
  }
  return out;
}

TEST(AssemblySampler, KnowABowlThatWasSeenFromOneSideWhateverModeCameFirst) {
  const Primitive bowl{
      Primitive::Form::ellipsoid, {0.13, 0.13, 0.07}, Eigen::Matrix3d::Identity(), {0.08, 0.08, 0.07}, 0.004};
  AssemblySamplerSettings settings;
  settings.count = 8;
  int hollow = 0;
  const int seeds = test::brief() ? 1 : 4;
  for (int seed = 1; seed <= seeds; ++seed) {
    AssemblySampler solids({0.26, 0.26}, settings, Random(static_cast<std::uint64_t>(seed), "solids"));
    solids.look(seen(bowl));
    const Assembly& best = solids.best();
    hollow += std::abs(best.distance({0.13, 0.13, 0.002})) < 0.008 && best.distance({0.13, 0.13, 0.05}) > 0.02 ? 1 : 0;
  }
  EXPECT_GE(hollow, seeds == 1 ? 1 : seeds - 1) << "the rest may have stayed in a mode that is wrong";
}

TEST(AssemblySampler, HaveNothingUnseenWhereATouchHasBeen) {
  AssemblySamplerSettings settings;
  settings.count = 4;
  settings.moves = 100;
  AssemblySampler solids({0.26, 0.26}, settings, Random(9, "solids"));
  Random random(9, "test/unseen");
  std::vector<SurfaceTouch> touches;
  std::size_t before = 300;
  for (int i = 0; i < 40; ++i) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Line line{kStanding.centre + 0.08 * random.uniform() * random_direction(random) - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    touches.push_back(
        {line, std::min(kStanding.first_intersection(line), desk), true, desk <= kStanding.first_intersection(line)});
    solids.add({touches.back()});
    if (i % 13 != 12) continue;
    const std::vector<Primitive> undiscovered = solids.undiscovered(solids.best(), 300, random);
    EXPECT_LT(undiscovered.size(), before) << "the more was touched, the less is left";
    before = undiscovered.size();
    EXPECT_GT(before, 0U);
    for (const Primitive& primitive : undiscovered) {
      for (const SurfaceTouch& touch : touches) {
        const Chord first = primitive.inside(touch.line)[0];
        if (first.empty() || first.begin >= touch.length) continue;
        EXPECT_LT(std::min((touch.length - first.begin) * first.begin_cosine, primitive.aside(touch.line)), 0.001);
      }
    }
  }
}

TEST(AssemblySampler, KeepWhatTheySumUpTrueThroughAllMoves) {
  Random random(8, "test/solids");
  AssemblySamplerSettings settings;
  settings.count = 6;
  settings.moves = 200;
  AssemblySampler solids({0.26, 0.26}, settings, Random(8, "solids"));
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 15; ++i) {
    const Vector3d out = random_direction(random);
    touches.push_back(
        {{Vector3d(0.13, 0.13, 0.1) + 0.2 * out, -out}, 0.1 + 0.05 * random.uniform(), i % 5 != 0, false});
    solids.add({touches.back()});
  }
  // A copy that takes in nothing new computes all of it again.
  for (const Assembly& one : solids.assemblies()) {
    EXPECT_TRUE(std::isfinite(one.posterior()));
    double prior = 0.0;
    for (const Assembly::Part& part : one.parts) {
      prior += part.prior;
      for (std::size_t i = 0; i < touches.size(); ++i)
        EXPECT_EQ(part.reach[i], touches[i].contact ? std::abs(part.primitive.distance(touches[i].end())) : 0.0);
    }
    EXPECT_NEAR(one.prior, prior, 1e-9);
    double likelihood = 0.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      double reach = touches[i].contact ? 0.3 : 0.0;
      double depth = 0.0;
      for (const Assembly::Part& part : one.parts) {
        reach = std::min(reach, part.reach[i]);
        depth = std::max(depth, part.depth[i]);
      }
      likelihood -= 2.0 * std::log1p((reach * reach + depth * depth) / (3.0 * settings.misfit * settings.misfit));
    }
    EXPECT_NEAR(one.likelihood, likelihood, 1e-9);
  }
}

/// Contacts with it from all sides but below, as they would be without noise.
std::vector<SurfaceTouch> touches_of(int count) {
  Random random(7, "test/solids");
  std::vector<SurfaceTouch> out;
  while (static_cast<int>(out.size()) < count) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Line line{kStanding.centre + 0.06 * random.uniform() * random_direction(random) - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    out.push_back(
        {line, std::min(kStanding.first_intersection(line), desk), true, desk <= kStanding.first_intersection(line)});
  }
  return out;
}

TEST(AssemblySampler, GoOnWhereNoAssemblyIsPossibleAtAll) {
  AssemblySamplerSettings settings;
  settings.count = 4;
  settings.moves = 20;
  settings.misfit = 1e-200;
  AssemblySampler solids({0.26, 0.26}, settings, Random(7, "solids"));
  for (const SurfaceTouch& touch : touches_of(5)) solids.add({touch});
  EXPECT_EQ(solids.assemblies().size(), 4U);
  EXPECT_THROW(shipped_config("any_side.yaml", {"belief.model_discrepancy=1e-200m"}), Error);
}

TEST(AssemblySampler, MakeNoPrimitiveOfOneContactInTheAirWhereATouchMayBeALie) {
  const Vector3d air(0.15, 0.14, 0.16);
  int made = 0, made_of_lies = 0;
  for (const double most : {kNoHit, 5.5}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      AssemblySamplerSettings settings;
      settings.count = 8;
      settings.moves = 300;
      settings.most = most;
      AssemblySampler solids({0.26, 0.26}, settings, Random(seed, "solids"));
      std::vector<SurfaceTouch> touches = touches_of(30);
      touches.insert(touches.begin() + 15, {{air + Vector3d(0, 0, 0.1), -Vector3d::UnitZ()}, 0.1, true, false});
      for (const SurfaceTouch& touch : touches) solids.add({touch});
      (most < kNoHit ? made : made_of_lies) += solids.best().distance(air) < 0.01 ? 1 : 0;
    }
  }
  EXPECT_GE(made_of_lies, 3) << "a contact that is no lie is of something";
  EXPECT_LE(made, 1);
}

TEST(AssemblySampler, AreWeighedByTouchesAsTheyAreReadNow) {
  AssemblySamplerSettings settings;
  settings.count = 6;
  settings.moves = 100;
  AssemblySampler solids({0.26, 0.26}, settings, Random(7, "solids"));
  std::vector<SurfaceTouch> touches = touches_of(12);
  for (const SurfaceTouch& touch : touches) solids.add({touch});
  for (SurfaceTouch& touch : touches) touch.length -= 0.004;
  solids.read_again(touches, 0.003, kNoHit);
  for (const Assembly& one : solids.assemblies()) {
    double likelihood = 0.0;
    for (const SurfaceTouch& touch : touches) {
      double reach = touch.desk ? 0.0 : 0.3;
      if (!touch.desk) reach = std::min(reach, std::abs(one.distance(touch.end())));
      double depth = 0.0;
      for (const Assembly::Part& part : one.parts)
        depth = std::max(depth, part.depth[static_cast<std::size_t>(&touch - touches.data())]);
      likelihood -= 2.0 * std::log1p((reach * reach + depth * depth) / (3.0 * 0.003 * 0.003));
    }
    EXPECT_NEAR(one.likelihood, likelihood, 1e-9);
  }
}

}  // namespace
}  // namespace palpate::test
