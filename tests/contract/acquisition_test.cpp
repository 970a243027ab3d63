// SPDX-License-Identifier: MIT
// The laws of acquisition.hpp, over every acquisition found: finite, complete and pure.
#include "support/plugins.hpp"

#include <palpate/acquisition.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

/// A belief whose maps are as written down.
class ScriptedBelief final : public Belief {
 public:
  ScriptedBelief(Eigen::Index count, int taps, double least_weight, double most_weight, double most_uncertainty)
      : taps_(taps), points_(count, 2), uncertainty_(count), weight_(count), mean_(count), variance_(count) {
    Random random(static_cast<std::uint64_t>(taps), "contract/belief");
    for (Eigen::Index i = 0; i < count; ++i) {
      points_.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
      uncertainty_(i) = most_uncertainty * random.uniform();
      weight_(i) = least_weight + (most_weight - least_weight) * random.uniform();
      mean_(i) = 0.1 * random.uniform();
      variance_(i) = uncertainty_(i);
    }
    probability_ = weight_.cwiseMax(0.0).cwiseMin(1.0);
  }

  const Points& candidates() const override { return points_; }
  Area area() const override { return {0.23, 0.23}; }
  int taps() const override { return taps_; }
  int initial_taps() const override { return 3; }
  const Eigen::VectorXd& uncertainty() const override { return seen(Quantity::uncertainty, uncertainty_); }
  const Eigen::VectorXd& weight() const override { return seen(Quantity::weight, weight_); }
  const Eigen::VectorXd& probability() const override { return seen(Quantity::probability, probability_); }
  const Eigen::VectorXd& height_mean() const override { return seen(Quantity::height, mean_); }
  const Eigen::VectorXd& height_variance() const override { return seen(Quantity::height, variance_); }

  /// What was read of it so far.
  Quantities read() const { return read_; }

 private:
  const Eigen::VectorXd& seen(Quantity one, const Eigen::VectorXd& map) const {
    read_ = read_ | one;
    return map;
  }

  mutable Quantities read_;
  int taps_;
  Points points_;
  Eigen::VectorXd uncertainty_, weight_, probability_, mean_, variance_;
};

/// Beliefs that a run meets: nothing known, the usual, weights far outside [0, 1], all known, one candidate.
std::vector<ScriptedBelief> beliefs() {
  std::vector<ScriptedBelief> out;
  out.emplace_back(25, 3, 0.0, 0.0, 1.0);
  out.emplace_back(25, 9, 0.0, 1.0, 1.0);
  out.emplace_back(25, 10, -40.0, 40.0, 1.0);
  out.emplace_back(25, 17, 0.0, 1.0, 0.0);
  out.emplace_back(25, 18, 0.0, 1.0, 1e-300);
  out.emplace_back(1, 4, 0.0, 1.0, 1.0);
  out.emplace_back(7, 2000000000, 0.0, 1.0, 1.0);
  return out;
}

Eigen::VectorXd score(const Acquisition& acquisition, const Belief& belief) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(belief.candidates().rows(), std::numeric_limits<double>::quiet_NaN());
  acquisition.score(belief, out);
  return out;
}

bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

class AcquisitionContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { acquisition_ = make<Acquisition>(contract_host(), GetParam()); }

  std::shared_ptr<Acquisition> acquisition_;
};

TEST_P(AcquisitionContract, GivesEveryCandidateAFiniteScore) {
  for (const ScriptedBelief& belief : beliefs()) {
    EXPECT_TRUE(score(*acquisition_, belief).allFinite()) << belief.taps() << " taps";
  }
}

TEST_P(AcquisitionContract, ReadsWhatItSaysThatItReadsAndAllOfThat) {
  Quantities read;
  for (const ScriptedBelief& belief : beliefs()) {
    score(*acquisition_, belief);  // throws for what it did not say
    read = read | belief.read();
  }
  EXPECT_TRUE(read == acquisition_->reads()) << "models that it does not read were built for it";
}

TEST_P(AcquisitionContract, IsPure) {
  const std::vector<ScriptedBelief> all = beliefs();
  std::vector<Eigen::VectorXd> first;
  for (const ScriptedBelief& belief : all) first.push_back(score(*acquisition_, belief));
  // In another order, and from an object that never saw the other beliefs.
  for (std::size_t i = all.size(); i-- > 0;) {
    EXPECT_TRUE(same_bytes(score(*acquisition_, all[i]), first[i]));
    EXPECT_TRUE(same_bytes(score(*make<Acquisition>(contract_host(), GetParam()), all[i]), first[i]));
  }
}

TEST_P(AcquisitionContract, WritesItsOutputAndNothingBesideIt) {
  const ScriptedBelief belief(5, 6, 0.0, 1.0, 1.0);
  Eigen::VectorXd around = Eigen::VectorXd::Constant(9, 7.25);
  acquisition_->score(belief, around.segment(2, 5));
  EXPECT_TRUE((around.head(2).array() == 7.25).all());
  EXPECT_TRUE((around.tail(2).array() == 7.25).all());
  EXPECT_TRUE(same_bytes(around.segment(2, 5), score(*acquisition_, belief)));
}

TEST_P(AcquisitionContract, HasAScale) {
  EXPECT_TRUE(std::isfinite(acquisition_->prior_scale()));
  EXPECT_GE(acquisition_->prior_scale(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Every, AcquisitionContract, testing::ValuesIn(plugins_under_contract("acquisition")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
