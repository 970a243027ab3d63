// SPDX-License-Identifier: MIT
// One solid of several parts is what its parts are.
#include "support/shape_cases.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

struct Placed {
  std::string type, options;  ///< the options without braces
  double at[2];               ///< in a frame in which the rectangle around all is 0 to 12 cm along, 0 to 7 cm across
  double degrees;

  std::string text(double east = 0.0, double north = 0.0) const {
    return "{type: " + type + ", " + options + ", at: [" + std::to_string(at[0] + east) + " m, " +
           std::to_string(at[1] + north) + " m], rotation: " + std::to_string(degrees) + " deg}";
  }
};

/// Two overlap, one stands apart, and one is turned.
const std::vector<Placed>& parts() {
  static const std::vector<Placed> all{{"block", "length: 8 cm, width: 2 cm, height: 3 cm", {0.04, 0.01}, 180},
                                       {"cylinder", "diameter: 4 cm, height: 5 cm", {0.1, 0.05}, 0},
                                       {"slope", "length: 4 cm, width: 2 cm, low: 1 cm, high: 6 cm", {0.05, 0.025}, 30},
                                       {"ellipsoid", "length: 3 cm, width: 2 cm, height: 2 cm", {0.02, 0.05}, -70}};
  return all;
}

std::string compound_of(const std::vector<Placed>& placed) {
  std::string out = "{parts: [";
  for (const Placed& one : placed) out += one.text() + ", ";
  return out + "]}";
}

const Vector3d kCentre(0.06, 0.035, 0.0);

TEST(Compound, IsAsHighInASceneAsItsPartsAreAsSeparateObjects) {
  const std::string whole = compound_of(parts());
  const auto one = scene_of({"{type: compound, at: [20 cm, 20 cm], " + whole.substr(1)});
  std::vector<std::string> objects;
  for (const Placed& part : parts()) objects.push_back(part.text(0.2 - kCentre.x(), 0.2 - kCentre.y()));
  const auto several = scene_of(objects);
  int on_object = 0;
  for (double x = 0.13; x < 0.27; x += 0.00171) {
    for (double y = 0.15; y < 0.25; y += 0.00171) {
      ASSERT_NEAR(one->height(x, y), several->height(x, y), 1e-12) << x << " " << y;
      on_object += one->height(x, y) > 0.0;
    }
  }
  EXPECT_GT(on_object, 500);
  EXPECT_NEAR(one->highest(), several->highest(), 1e-15);
}

TEST(Compound, IsMetFirstWhereOneOfItsPartsIsAndReachesAsFarAsTheOneThatReachesFarthest) {
  const auto whole = make<Shape>(shared_host(), "compound", compound_of(parts()));
  std::vector<std::shared_ptr<Shape>> shapes;
  std::vector<Eigen::Isometry3d> frames;  // from the part's to that of the whole
  for (const Placed& part : parts()) {
    shapes.push_back(make<Shape>(shared_host(), part.type, "{" + part.options + "}"));
    frames.push_back(Eigen::Translation3d(Vector3d(part.at[0], part.at[1], 0) - kCentre) *
                     Eigen::AngleAxisd(part.degrees * std::acos(-1.0) / 180, Vector3d::UnitZ()));
  }
  Random random(1, "test/compound");
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Vector3d direction = random_direction(random);
    double most = -HUGE_VAL;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const Vector3d turned = frames[k].linear().transpose() * direction;
      most = std::max(most, direction.dot(frames[k].translation()) + shapes[k]->support(turned));
    }
    EXPECT_NEAR(whole->support(direction), most, 1e-14);
    direction.z() = -std::abs(direction.z()) - 0.1;
    direction.normalize();
    const Vector3d origin(0.14 * (random.uniform() - 0.5), 0.1 * (random.uniform() - 0.5), 0.06 * random.uniform());
    double first = HUGE_VAL;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      first = std::min(first, shapes[k]->first_intersection(
                                  {frames[k].inverse() * origin, frames[k].linear().transpose() * direction}));
    }
    const double hit = whole->first_intersection({origin, direction});
    ASSERT_EQ(std::isinf(hit), std::isinf(first));
    if (std::isinf(hit)) continue;
    ++hits;
    EXPECT_NEAR(hit, first, 1e-11);
  }
  EXPECT_GT(hits, 500);
}

TEST(Compound, OfOnePartIsThatPartWhereverThePartIs) {
  const auto whole = make<Shape>(shared_host(), "compound", "{parts: [{type: wave, at: [5 cm, -3 cm]}]}");
  const auto part = make<Shape>(shared_host(), "wave");
  Random random(2, "test/compound");
  for (int i = 0; i < 1000; ++i) {
    const double s = 0.2 * (random.uniform() - 0.5);
    const double t = 0.08 * (random.uniform() - 0.5);
    const double there = part->top(s, t);
    EXPECT_TRUE(whole->top(s, t) == there || std::abs(whole->top(s, t) - there) < 1e-15) << s << " " << t;
    const Vector3d direction = random_direction(random);
    EXPECT_NEAR(whole->support(direction), part->support(direction), 1e-15);
  }
}

TEST(Compound, HasPartsThatAreCompoundsAsDeepAsAConfigMayBe) {
  std::string before, behind;
  for (int i = 0; i < 40; ++i) {
    before += "parts: [{type: compound, ";
    behind += "}]";
  }
  const std::string cone = "parts: [{type: cone, diameter: 8 cm, height: 5 cm}]";
  const auto scene = scene_of({"{type: compound, at: [20 cm, 20 cm], " + before + cone + behind + "}"});
  EXPECT_NEAR(scene->height(0.2, 0.2), 0.05, 1e-12);
}

}  // namespace
}  // namespace palpate::test
