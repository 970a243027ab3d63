// SPDX-License-Identifier: MIT
// The laws of acquisition.hpp, over every acquisition found: finite, complete and pure.
#include "support/arrays.hpp"
#include "support/mocks.hpp"
#include "support/testing.hpp"

#include <palpate/acquisition.hpp>

namespace palpate::test {
namespace {

/// A belief from above of `count` candidates whose arrays are drawn.
WrittenBelief drawn(Eigen::Index count, int taps, double least_weight, double most_weight, double most_uncertainty) {
  WrittenBelief out;
  out.tapped = {taps, std::min(taps, 3)};
  Random random(static_cast<std::uint64_t>(taps), "contract/belief");
  const auto draw = [&](double low, double high) -> Eigen::VectorXd {
    return Eigen::VectorXd::NullaryExpr(count, [&] { return low + (high - low) * random.uniform(); });
  };
  out.lines.starts.setZero(count, 3);
  out.lines.starts.leftCols<2>() << draw(0.0, 0.23), draw(0.0, 0.23);
  out.lines.directions = Eigen::RowVector3d(0.0, 0.0, -1.0);
  out.lines.lengths = Eigen::VectorXd::Constant(1, 0.6);
  out.lines.from_above = true;
  out.arrays[quantity::kUncertainty] = draw(0.0, most_uncertainty);
  out.arrays[quantity::kLabelMean] = draw(least_weight, most_weight);
  out.arrays[quantity::kHeightMean] = draw(0.0, 0.1);
  out.arrays[quantity::kHeightStd] = out.arrays[quantity::kUncertainty].cwiseSqrt();
  out.arrays[quantity::kMeasurementStd] = out.arrays[quantity::kHeightStd];
  out.arrays[quantity::kExpectedDistance] = 0.5 - out.arrays[quantity::kHeightMean].array();
  out.arrays[quantity::kObjectProbability] = out.arrays[quantity::kLabelMean].cwiseMax(0.0).cwiseMin(1.0);
  return out;
}

/// Beliefs that a run meets: nothing known, the usual, weights far outside [0, 1], all known, one candidate.
std::vector<WrittenBelief> beliefs() {
  return {drawn(25, 3, 0.0, 0.0, 1.0),        drawn(25, 9, 0.0, 1.0, 1.0),     drawn(25, 10, -40.0, 40.0, 1.0),
          drawn(25, 17, 0.0, 1.0, 0.0),       drawn(25, 18, 0.0, 1.0, 1e-300), drawn(1, 4, 0.0, 1.0, 1.0),
          drawn(7, 2000000000, 0.0, 1.0, 1.0)};
}

/// Beliefs from any side: the usual, nothing met, nothing to find, all of it known.
std::vector<WrittenBelief> surfaces() {
  using namespace quantity;
  std::vector<WrittenBelief> out(4);
  Random random(5, "contract/surface");
  for (WrittenBelief& one : out) {
    const auto draw = [&](double most) -> Eigen::VectorXd {
      return Eigen::VectorXd::NullaryExpr(20, [&] { return most * random.uniform(); });
    };
    one.tapped = {7, 3};
    one.lines.starts.setZero(20, 3);
    one.lines.directions = Eigen::RowVector3d(0.0, 0.0, -1.0).replicate(20, 1);
    one.lines.lengths = Eigen::VectorXd::Constant(20, 0.6);
    one.lines.fixed = false;
    one.arrays[kExpectedDistance] = draw(0.4).array() + 0.05;
    one.arrays[kExpectedDiscovery] = draw(0.001);
    one.arrays[kStdReduction] = draw(0.0002);
    one.arrays[kSurfaceStd] = draw(0.006);
    one.arrays[kIncidenceCosine] = draw(1.0);
    for (Eigen::Index i = 1; i < 20; i += 2) one.arrays[kIncidenceCosine](i) = 1.0;
  }
  out[1].arrays[kSurfaceStd].setZero();
  out[1].arrays[kIncidenceCosine].setZero();
  out[1].arrays[kStdReduction].setZero();
  out[2].arrays[kExpectedDiscovery].setZero();
  out[3].arrays[kSurfaceStd].setZero();
  for (WrittenBelief& one : out) {
    const Eigen::VectorXd& sigma = one.arrays[kSurfaceStd];
    one.arrays[kMeasurementStd] = sigma;
    const double most = sigma.maxCoeff();
    const Eigen::VectorXd square = (sigma / (most > 0.0 ? most : 1.0)).cwiseAbs2();
    one.arrays[kUncertainty] = (one.arrays[kIncidenceCosine].array() == 1.0).select(square.array(), 0.0);
  }
  return out;
}

/// Returns `all` with drawn values of those `quantities` that only beliefs of others offer.
std::vector<WrittenBelief> with_foreign(std::vector<WrittenBelief> all, const QuantitySet& quantities) {
  QuantitySet own{quantity::kHypotheses, quantity::kDeskPosition};
  for (const WrittenBelief& one : {beliefs().front(), surfaces().front()}) {
    for (const auto& [name, values] : one.arrays) own.insert(name);
  }
  Random random(6, "contract/foreign");
  for (WrittenBelief& one : all) {
    for (const std::string& name : quantities) {
      if (own.count(name) != 0) continue;
      one.arrays[name] = Eigen::VectorXd::NullaryExpr(one.lines.size(), [&] { return random.uniform(); });
    }
  }
  return all;
}

/// Returns whether a belief offers these quantities; hypotheses and positions on the desk are of those from above.
bool offers(const WrittenBelief& belief, const QuantitySet& quantities) {
  return std::all_of(quantities.begin(), quantities.end(), [&](const std::string& one) {
    const bool from_above = one == quantity::kHypotheses || one == quantity::kDeskPosition;
    return from_above ? belief.lines.from_above : belief.arrays.count(one) != 0;
  });
}

Eigen::VectorXd score(const Acquisition& acquisition, const BeliefView& belief) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(belief.candidates().size(), std::numeric_limits<double>::quiet_NaN());
  acquisition.score(belief, out);
  return out;
}

/// Returns the quantities that are read of `all` beliefs. Positions on the desk are read if they change a score.
QuantitySet read_of(const Acquisition& acquisition, const std::vector<WrittenBelief>& all) {
  QuantitySet out;
  for (const WrittenBelief& belief : all) {
    belief.read.clear();
    const Eigen::VectorXd scores = score(acquisition, belief);  // throws for a quantity that it did not declare
    out = out | belief.read;
    WrittenBelief elsewhere = belief;
    elsewhere.lines.starts.leftCols<2>().array() *= 0.5;
    if (!same_bytes(score(acquisition, elsewhere), scores)) out.insert(quantity::kDeskPosition);
  }
  return out;
}

class AcquisitionContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    acquisition_ = make<Acquisition>(contract_host(), GetParam());
    beliefs_ = with_foreign(beliefs(), acquisition_->reads());
    surfaces_ = with_foreign(surfaces(), acquisition_->reads());
    from_above_ = offers(beliefs_.front(), acquisition_->reads());
    any_side_ = offers(surfaces_.front(), acquisition_->reads());
  }

  /// Returns the beliefs that offer what it reads.
  std::vector<WrittenBelief> readable() const {
    std::vector<WrittenBelief> out;
    if (from_above_) out = beliefs_;
    if (any_side_) out.insert(out.end(), surfaces_.begin(), surfaces_.end());
    return out;
  }

  std::shared_ptr<Acquisition> acquisition_;
  std::vector<WrittenBelief> beliefs_, surfaces_;  ///< with the quantities of others that it reads
  bool from_above_ = false, any_side_ = false;     ///< of the beliefs that offer what it reads
};

TEST_P(AcquisitionContract, GivesEveryCandidateAFiniteScore) {
  for (const WrittenBelief& belief : readable()) {
    EXPECT_TRUE(score(*acquisition_, belief).allFinite()) << belief.tapped.count << " taps";
  }
}

TEST_P(AcquisitionContract, ReadsWhatItSaysThatItReadsAndAllOfThat) {
  EXPECT_THAT(read_of(*acquisition_, readable()), ::testing::ContainerEq(acquisition_->reads()))
      << "models that it does not read were built for it";
}

TEST_P(AcquisitionContract, IsPure) {
  const std::vector<WrittenBelief> all = readable();
  std::vector<Eigen::VectorXd> first;
  for (const WrittenBelief& belief : all) first.push_back(score(*acquisition_, belief));
  // In another order, and from an object that never saw the other beliefs.
  for (std::size_t i = all.size(); i-- > 0;) {
    EXPECT_TRUE(same_bytes(score(*acquisition_, all[i]), first[i]));
    EXPECT_TRUE(same_bytes(score(*make<Acquisition>(contract_host(), GetParam()), all[i]), first[i]));
  }
}

TEST_P(AcquisitionContract, WritesItsOutputAndNothingBesideIt) {
  const WrittenBelief belief = readable().front();
  const Eigen::MatrixXd scores =
      written_inside(belief.lines.size(), 1, [&](MatrixOut out) { acquisition_->score(belief, out.col(0)); });
  EXPECT_TRUE(same_bytes(scores.col(0), score(*acquisition_, belief)));
}

TEST_P(AcquisitionContract, HasAScale) {
  EXPECT_TRUE(std::isfinite(acquisition_->prior_scale()));
  EXPECT_GE(acquisition_->prior_scale(), 0.0);
}

TEST_P(AcquisitionContract, FromAnySideIsFinitePureAndReadsWhatItSays) {
  EXPECT_TRUE(from_above_ || any_side_) << "no belief offers what it reads";
  if (!any_side_) return;
  for (const WrittenBelief& belief : surfaces_) {
    const Eigen::VectorXd scores = score(*acquisition_, belief);
    EXPECT_TRUE(scores.allFinite());
    EXPECT_TRUE(same_bytes(score(*make<Acquisition>(contract_host(), GetParam()), belief), scores));
  }
  EXPECT_THAT(read_of(*acquisition_, surfaces_), ::testing::ContainerEq(acquisition_->reads()))
      << "models that it does not read were built for it";
}

TEST(Acquisitions, FromAnySideTakeTheLargestVarianceAlongTheNormalOrWhereMostIsExpectedToBeFound) {
  using namespace quantity;
  const std::vector<WrittenBelief> all = surfaces();
  const auto array = [&](std::size_t belief, const char* name) { return all[belief].arrays.at(name); };
  const auto best = [](const Eigen::VectorXd& values) {
    Eigen::Index at = 0;
    values.maxCoeff(&at);
    return at;
  };
  const std::shared_ptr<Acquisition> uncertainty = make<Acquisition>(contract_host(), "uncertainty");
  const Eigen::VectorXd square = (array(0, kIncidenceCosine).array() == 1.0).select(array(0, kSurfaceStd).array(), 0.0);
  EXPECT_EQ(best(score(*uncertainty, all[0])), best(square));
  const std::shared_ptr<Acquisition> discovery = make<Acquisition>(contract_host(), "discovery");
  EXPECT_EQ(best(score(*discovery, all[1])), best(array(1, kExpectedDiscovery))) << "nothing is met";
  EXPECT_EQ(best(score(*discovery, all[2])), best(array(2, kStdReduction))) << "nothing is to be found";
  EXPECT_EQ(score(*discovery, all[0]), Eigen::VectorXd(array(0, kExpectedDiscovery) + array(0, kStdReduction)))
      << "both in metres";
  const std::shared_ptr<Acquisition> hasty =
      make<Acquisition>(contract_host(), "discovery", "{travel_cost_exponent: 1}");
  Eigen::Index near = 0;
  array(0, kExpectedDistance).minCoeff(&near);
  const Eigen::VectorXd kept = score(*hasty, all[0]).cwiseQuotient(score(*discovery, all[0]));
  EXPECT_EQ(best(kept), near) << "of a short way most is left";
  EXPECT_THAT(read_of(*hasty, all), ::testing::ContainerEq(hasty->reads())) << "the distance, if it is divided by it";
}

INSTANTIATE_TEST_SUITE_P(Every, AcquisitionContract, testing::ValuesIn(plugins_under_contract("acquisition")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
