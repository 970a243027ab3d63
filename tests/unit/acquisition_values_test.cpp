// SPDX-License-Identifier: MIT
// What the acquisitions make of maps that are written down, and what those that are made of others make of their parts.
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/acquisition.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate::test {
namespace {

/// Five candidates, of which only what the scores here read is known.
class Maps final : public Belief {
 public:
  Maps() : places_(Points::Zero(5, 2)), u_(5), w_(5), p_(5) {
    u_ << 1.0, 0.5, 0.2, 0.0, 0.8;
    w_ << 0.1, 1.2, -0.3, 0.5, 0.0;
    p_ << 0.0, 0.25, 0.5, 1.0, 0.9;
  }
  const Points& candidates() const override { return places_; }
  Area area() const override { return {0.23, 0.23}; }
  int taps() const override { return 4; }
  int initial_taps() const override { return 1; }
  const Eigen::VectorXd& uncertainty() const override { return u_; }
  const Eigen::VectorXd& weight() const override { return w_; }
  const Eigen::VectorXd& probability() const override { return p_; }
  const Eigen::VectorXd& height_mean() const override { return p_; }
  const Eigen::VectorXd& height_variance() const override { return u_; }

 private:
  Points places_;
  Eigen::VectorXd u_, w_, p_;
};

/// The scores of `name`, which leaves what stands beside them alone.
std::vector<double> scores(const std::string& name, const std::string& options = "{}") {
  const auto acquisition = make<Acquisition>(shared_host(), name, options);
  Eigen::VectorXd around = Eigen::VectorXd::Constant(7, 7.25);
  acquisition->score(Maps(), around.segment(1, 5));
  EXPECT_EQ(around(0), 7.25);
  EXPECT_EQ(around(6), 7.25);
  return {around.data() + 1, around.data() + 6};
}

double scale_of(const std::string& name, const std::string& options) {
  return make<Acquisition>(shared_host(), name, options)->prior_scale();
}

testing::Matcher<std::vector<double>> near(const std::vector<double>& expected) {
  return testing::Pointwise(testing::DoubleNear(1e-14), expected);
}

// -p log2 p - (1 - p) log2 (1 - p), to 16 digits.
const std::vector<double> kBits{0.0, 0.8112781244591328, 1.0, 0.0, 0.4689955935892812};

// Square roots of the uncertainties, to 16 digits.
const std::vector<double> kDeep{1.0, 0.7071067811865476, 0.4472135954999579, 0.0, 0.8944271909999159};

TEST(AcquisitionValues, OutlineIsTheEntropyOfTheFootprintInBits) { EXPECT_THAT(scores("outline"), near(kBits)); }

TEST(AcquisitionValues, InsideIsTheStandardDeviationTimesTheProbabilityNotTimesTheWeight) {
  EXPECT_THAT(scores("inside"), near({0.0, kDeep[1] * 0.25, kDeep[2] * 0.5, 0.0, kDeep[4] * 0.9}));
  EXPECT_THAT(scores("weighted"), near({0.1, 0.6, -0.06, 0.0, 0.0}));
}

TEST(AcquisitionValues, AMixtureIsTheSumOfItsPartsAndAScaleATimesItsPart) {
  const std::string parts =
      "{acquisitions: [{type: scale, factor: 0.7, acquisition: {type: outline}}, "
      "{type: scale, factor: 0.3, acquisition: {type: inside}}]}";
  EXPECT_THAT(scores("mixture", parts), near({0.0, 0.7 * kBits[1] + 0.3 * kDeep[1] * 0.25, 0.7 + 0.3 * kDeep[2] * 0.5,
                                              0.0, 0.7 * kBits[4] + 0.3 * kDeep[4] * 0.9}));
  EXPECT_DOUBLE_EQ(scale_of("mixture", parts), 1.0);
  EXPECT_THAT(scores("scale", "{factor: 2.5, acquisition: {type: uncertainty}}"), near({2.5, 1.25, 0.5, 0.0, 2.0}));
  EXPECT_DOUBLE_EQ(scale_of("scale", "{factor: 2.5, acquisition: {type: uncertainty}}"), 2.5);
}

}  // namespace
}  // namespace palpate::test
