// SPDX-License-Identifier: MIT
// The laws of acquisition.hpp, over every acquisition found: finite, complete and pure.
#include "support/arrays.hpp"
#include "support/mocks.hpp"
#include "support/testing.hpp"

#include <palpate/acquisition.hpp>

namespace palpate::test {
namespace {

/// A belief of `count` candidates whose maps are drawn.
WrittenBelief drawn(Eigen::Index count, int taps, double least_weight, double most_weight, double most_uncertainty) {
  WrittenBelief out;
  out.count = taps;
  Random random(static_cast<std::uint64_t>(taps), "contract/belief");
  const auto draw = [&](double low, double high) -> Eigen::VectorXd {
    return Eigen::VectorXd::NullaryExpr(count, [&] { return low + (high - low) * random.uniform(); });
  };
  out.places.resize(count, 2);
  out.places << draw(0.0, 0.23), draw(0.0, 0.23);
  out.u = draw(0.0, most_uncertainty);
  out.w = draw(least_weight, most_weight);
  out.mean = draw(0.0, 0.1);
  out.variance = out.u;
  out.p = out.w.cwiseMax(0.0).cwiseMin(1.0);
  return out;
}

/// Beliefs that a run meets: nothing known, the usual, weights far outside [0, 1], all known, one candidate.
std::vector<WrittenBelief> beliefs() {
  return {drawn(25, 3, 0.0, 0.0, 1.0),        drawn(25, 9, 0.0, 1.0, 1.0),     drawn(25, 10, -40.0, 40.0, 1.0),
          drawn(25, 17, 0.0, 1.0, 0.0),       drawn(25, 18, 0.0, 1.0, 1e-300), drawn(1, 4, 0.0, 1.0, 1.0),
          drawn(7, 2000000000, 0.0, 1.0, 1.0)};
}

Eigen::VectorXd score(const Acquisition& acquisition, const Belief& belief) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(belief.candidates().rows(), std::numeric_limits<double>::quiet_NaN());
  acquisition.score(belief, out);
  return out;
}

class AcquisitionContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { acquisition_ = make<Acquisition>(contract_host(), GetParam()); }

  std::shared_ptr<Acquisition> acquisition_;
};

TEST_P(AcquisitionContract, GivesEveryCandidateAFiniteScore) {
  for (const WrittenBelief& belief : beliefs()) {
    EXPECT_TRUE(score(*acquisition_, belief).allFinite()) << belief.taps() << " taps";
  }
}

TEST_P(AcquisitionContract, ReadsWhatItSaysThatItReadsAndAllOfThat) {
  Quantities read;
  for (const WrittenBelief& belief : beliefs()) {
    score(*acquisition_, belief);  // throws for what it did not say
    read = read | belief.read;
  }
  EXPECT_TRUE(read == acquisition_->reads()) << "models that it does not read were built for it";
}

TEST_P(AcquisitionContract, IsPure) {
  const std::vector<WrittenBelief> all = beliefs();
  std::vector<Eigen::VectorXd> first;
  for (const WrittenBelief& belief : all) first.push_back(score(*acquisition_, belief));
  // In another order, and from an object that never saw the other beliefs.
  for (std::size_t i = all.size(); i-- > 0;) {
    EXPECT_TRUE(same_bytes(score(*acquisition_, all[i]), first[i]));
    EXPECT_TRUE(same_bytes(score(*make<Acquisition>(contract_host(), GetParam()), all[i]), first[i]));
  }
}

TEST_P(AcquisitionContract, WritesItsOutputAndNothingBesideIt) {
  const WrittenBelief belief = drawn(5, 6, 0.0, 1.0, 1.0);
  const Eigen::MatrixXd scores = written_inside(5, 1, [&](MatrixOut out) { acquisition_->score(belief, out.col(0)); });
  EXPECT_TRUE(same_bytes(scores.col(0), score(*acquisition_, belief)));
}

TEST_P(AcquisitionContract, HasAScale) {
  EXPECT_TRUE(std::isfinite(acquisition_->prior_scale()));
  EXPECT_GE(acquisition_->prior_scale(), 0.0);
}

/// Beliefs from any side: the usual, nothing met, nothing to find, all of it known.
std::vector<WrittenSurface> surfaces() {
  std::vector<WrittenSurface> out(4);
  Random random(5, "contract/surface");
  for (WrittenSurface& one : out) {
    const auto draw = [&](double most) -> Eigen::VectorXd {
      return Eigen::VectorXd::NullaryExpr(20, [&] { return most * random.uniform(); });
    };
    one.count = 7;
    one.lines.resize(20);
    one.ways = draw(0.4).array() + 0.05;
    one.found = draw(0.001);
    one.taken = draw(0.0002);
    one.sigma = draw(0.006);
    one.square = draw(1.0);
    for (Eigen::Index i = 1; i < 20; i += 2) one.square(i) = 1.0;
  }
  out[1].sigma.setZero();
  out[1].square.setZero();
  out[1].taken.setZero();
  out[2].found.setZero();
  out[3].sigma.setZero();
  return out;
}

Eigen::VectorXd score(const Acquisition& acquisition, const SurfaceBelief& belief) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(20, std::numeric_limits<double>::quiet_NaN());
  acquisition.score_approaches(belief, out);
  return out;
}

TEST_P(AcquisitionContract, FromAnySideIsFinitePureAndReadsWhatItSays) {
  EXPECT_TRUE(acquisition_->from_above() || acquisition_->any_side());
  if (!acquisition_->any_side()) return;
  Quantities read;
  for (const WrittenSurface& belief : surfaces()) {
    const Eigen::VectorXd scores = score(*acquisition_, belief);
    EXPECT_TRUE(scores.allFinite());
    EXPECT_TRUE(same_bytes(score(*make<Acquisition>(contract_host(), GetParam()), belief), scores));
    read = read | belief.read;
  }
  EXPECT_TRUE(read == acquisition_->reads_of_approaches()) << "models that it does not read were built for it";
}

TEST(Acquisitions, FromAnySideTakeTheLargestVarianceAlongTheNormalOrWhereMostIsExpectedToBeFound) {
  const std::vector<WrittenSurface> all = surfaces();
  const auto best = [](const Eigen::VectorXd& values) {
    Eigen::Index at = 0;
    values.maxCoeff(&at);
    return at;
  };
  const std::shared_ptr<Acquisition> uncertainty = make<Acquisition>(contract_host(), "uncertainty");
  const Eigen::VectorXd square = (all[0].square.array() == 1.0).select(all[0].sigma.array(), 0.0);
  EXPECT_EQ(best(score(*uncertainty, all[0])), best(square));
  const std::shared_ptr<Acquisition> discovery = make<Acquisition>(contract_host(), "discovery");
  EXPECT_EQ(best(score(*discovery, all[1])), best(all[1].found)) << "nothing is met";
  EXPECT_EQ(best(score(*discovery, all[2])), best(all[2].taken)) << "nothing is to be found";
  EXPECT_EQ(score(*discovery, all[0]), Eigen::VectorXd(all[0].found + all[0].taken)) << "both in metres";
  const std::shared_ptr<Acquisition> hasty =
      make<Acquisition>(contract_host(), "discovery", "{travel_cost_exponent: 1}");
  Eigen::Index near = 0;
  all[0].ways.minCoeff(&near);
  const Eigen::VectorXd kept = score(*hasty, all[0]).cwiseQuotient(score(*discovery, all[0]));
  EXPECT_EQ(best(kept), near) << "of a short way most is left";
}

INSTANTIATE_TEST_SUITE_P(Every, AcquisitionContract, testing::ValuesIn(plugins_under_contract("acquisition")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
