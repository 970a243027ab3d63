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

INSTANTIATE_TEST_SUITE_P(Every, AcquisitionContract, testing::ValuesIn(plugins_under_contract("acquisition")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
