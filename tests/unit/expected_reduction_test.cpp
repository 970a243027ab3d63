// SPDX-License-Identifier: MIT
// What a poke is expected to take off the deviation of a surface, against the formulas for normal distributions.
#include "solids/expected_reduction.hpp"

#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/LU>

#include <cmath>
#include <set>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kNoise = 0.0005;

/// A box that is touched from all sides, and what is believed of it: assemblies that differ, as they moved little.
class Reductions : public testing::Test {
 protected:
  explicit Reductions(int touches = 25, double noise = kNoise)
      : residual_gp(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, noise}) {
    Random random(4, "test/reduction");
    for (int i = 0; i < touches; ++i) touch(random);
    residual_gp.fit(solids.best(), all);
    for (int i = 0; i < 400; ++i) {
      const Line line = towards(random);
      const double hit = solids.best().first_intersection(line);
      if (hit == kNoHit) continue;
      const Vector3d at = line.origin + hit * line.direction;
      places.push_back({at, solids.best().normal(at)});
    }
    some = representatives(places, 60).places;
  }

  static AssemblySamplerSettings few() {
    AssemblySamplerSettings out;
    out.count = 6;
    out.moves = 150;
    return out;
  }
  Line towards(Random& random) const {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const double away = 0.04 * random.uniform();
    return {box.centre + away * random_direction(random) - 0.3 * direction, direction};
  }
  void touch(Random& random) {
    const Line line = towards(random);
    const double desk = -line.origin.z() / line.direction.z();
    const double hit = box.first_intersection(line);
    all.push_back({line, std::min(hit, desk), true, desk <= hit});
    solids.add({all.back()});
  }
  double offset(const Assembly& one, const Vector3d& at) const {
    const double far = solids.best().distance(at) - one.distance(at);
    return std::max(-0.02, std::min(0.02, far));
  }
  /// The covariance of what is off, contacts first, as expected_reduction.hpp has it.
  MatrixXd covariance(const ResidualGp::Places& at) const {
    std::vector<ResidualGp::ResidualDatum> rows(at.size());
    std::transform(at.begin(), at.end(), rows.begin(),
                   [](const ResidualGp::Place& one) { return ResidualGp::ResidualDatum{one}; });
    MatrixXd out = residual_gp.covariance(rows);
    for (const Assembly& one : solids.assemblies()) {
      for (Eigen::Index i = 0; i < out.rows(); ++i) {
        for (Eigen::Index j = 0; j < out.cols(); ++j) {
          out(i, j) += offset(one, at[static_cast<std::size_t>(i)].at) *
                       offset(one, at[static_cast<std::size_t>(j)].at) /
                       static_cast<double>(solids.assemblies().size());
        }
      }
    }
    return out;
  }
  ResidualGp::Places contacts() const {
    ResidualGp::Places out;
    for (const ResidualGp::ResidualDatum& row : residual_gp.rows()) {
      if (!row.free) out.push_back(row.place);
    }
    return out;
  }
  /// The mean standard deviation of `some`, given contacts at these places.
  double deviation_given(const ResidualGp::Places& known) const {
    ResidualGp::Places at = known;
    at.insert(at.end(), some.begin(), some.end());
    const MatrixXd all_of_it = covariance(at);
    const auto n = static_cast<Eigen::Index>(known.size());
    const auto m = static_cast<Eigen::Index>(some.size());
    MatrixXd left = all_of_it.bottomRightCorner(m, m);
    if (n > 0) {
      MatrixXd noisy = all_of_it.topLeftCorner(n, n);
      noisy.diagonal().array() += residual_gp.noise() * residual_gp.noise();
      left -= all_of_it.bottomLeftCorner(m, n) * noisy.fullPivLu().inverse() * all_of_it.topRightCorner(n, m);
    }
    return left.diagonal().cwiseMax(0.0).cwiseSqrt().mean();
  }

  const Primitive box{Primitive::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  AssemblySampler solids{{0.26, 0.26}, few(), Random(9, "solids")};
  ResidualGp residual_gp;
  std::vector<SurfaceTouch> all;
  ResidualGp::Places places, some;
};

TEST_F(Reductions, AreWhatOneContactMoreTakesOffTheMeanDeviation) {
  ASSERT_GT(contacts().size(), 5U);
  ASSERT_GT(some.size(), 20U);
  const Eigen::VectorXd found = expected_reductions(solids, residual_gp, some);
  const double before = deviation_given(contacts());
  for (std::size_t i = 0; i < some.size(); ++i) {
    ResidualGp::Places known = contacts();
    known.push_back(some[i]);
    // Rounding: the inverse of a matrix with a condition of 1e6, and a slack of 1e-9 of the diagonal.
    EXPECT_NEAR(found(static_cast<Eigen::Index>(i)), before - deviation_given(known), 1e-6 * before);
    EXPECT_GT(found(static_cast<Eigen::Index>(i)), 0.0);
    EXPECT_LT(found(static_cast<Eigen::Index>(i)), before);
  }
}

TEST_F(Reductions, AreLessWhereTheSurfaceWasTouchedThanElsewhere) {
  ResidualGp::Places with = some;
  const std::size_t first = with.size();
  for (const ResidualGp::Place& place : contacts()) with.push_back(place);
  const Eigen::VectorXd found = expected_reductions(solids, residual_gp, with);
  const auto n = static_cast<Eigen::Index>(first);
  EXPECT_LT(found.tail(found.size() - n).mean(), 0.2 * found.head(n).maxCoeff()) << "a contact twice tells little";
}

class WithoutNoise : public Reductions {
 protected:
  WithoutNoise() : Reductions(25, 0.0) {}
};

TEST_F(WithoutNoise, AreFiniteWhereTheSameContactIsMadeAgain) {
  const std::vector<SurfaceTouch> once = all;
  for (int i = 0; i < 3; ++i) all.insert(all.end(), once.begin(), once.end());
  residual_gp.fit(solids.best(), all);
  const Eigen::VectorXd found = expected_reductions(solids, residual_gp, some);
  EXPECT_TRUE(found.allFinite());
  EXPECT_GE(found.minCoeff(), 0.0);
  EXPECT_GT(found.maxCoeff(), 0.0);
}

class BeforeAnyTouch : public Reductions {
 protected:
  BeforeAnyTouch() : Reductions(0) {}
};

TEST_F(BeforeAnyTouch, AreThoseOfThePrior) {
  ASSERT_TRUE(contacts().empty());
  const Eigen::VectorXd found = expected_reductions(solids, residual_gp, some);
  for (std::size_t i = 0; i < some.size(); ++i)
    EXPECT_NEAR(found(static_cast<Eigen::Index>(i)), deviation_given({}) - deviation_given({some[i]}), 1e-9);
}

TEST_F(Reductions, AreNoneWhereNoPlaceIsAsked) {
  EXPECT_EQ(expected_reductions(solids, residual_gp, {}).size(), 0);
  EXPECT_TRUE(representatives({}, 60).places.empty());
}

TEST_F(Reductions, AreAskedOfPlacesThatStandForAllNearThemOnTheSameSide) {
  for (const std::size_t most : {60U, 150U, 400U}) {
    const Representatives found = representatives(places, most);
    EXPECT_LE(found.places.size(), most);
    EXPECT_GT(found.places.size(), std::min<std::size_t>(most, places.size()) / 4);
    ASSERT_EQ(found.stands_for.size(), places.size());
    std::set<std::size_t> used;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const ResidualGp::Place& other = found.places[found.stands_for[i]];
      used.insert(found.stands_for[i]);
      Eigen::Index axis = 0;
      other.normal.cwiseAbs().maxCoeff(&axis);
      EXPECT_GT(other.normal(axis) * places[i].normal(axis), 0.0) << "the other side of a wall";
    }
    EXPECT_EQ(used.size(), found.places.size()) << "each stands for itself";
  }
  const Representatives fine = representatives(places, 100000);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_LT((fine.places[fine.stands_for[i]].at - places[i].at).norm(), 0.008 * std::sqrt(3.0))
        << "the diagonal of a cube";
  }
}

}  // namespace
}  // namespace palpate::test
