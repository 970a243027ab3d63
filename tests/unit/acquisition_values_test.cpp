// SPDX-License-Identifier: MIT
// What the acquisitions make of maps that are written down, and what those that are made of others make of their parts.
#include "support/mocks.hpp"
#include "support/testing.hpp"

#include <palpate/acquisition.hpp>

namespace palpate::test {
namespace {

/// Five candidates, of which only what the scores here read is known.
WrittenBelief maps() {
  WrittenBelief out;
  out.tapped.count = 4;
  out.lines.starts = Points3::Zero(5, 3);
  out.arrays[quantity::kUncertainty] = Eigen::VectorXd{{1.0, 0.5, 0.2, 0.0, 0.8}};
  out.arrays[quantity::kLabelMean] = Eigen::VectorXd{{0.1, 1.2, -0.3, 0.5, 0.0}};
  out.arrays[quantity::kObjectProbability] = Eigen::VectorXd{{0.0, 0.25, 0.5, 1.0, 0.9}};
  return out;
}

std::vector<double> scores(const std::string& name, const std::string& options = "{}") {
  const auto acquisition = make<Acquisition>(shared_host(), name, options);
  Eigen::VectorXd out(5);
  acquisition->score(maps(), out);
  return {out.data(), out.data() + 5};
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

TEST(AcquisitionValues, FootprintEntropyIsTheEntropyOfTheFootprintInBits) {
  EXPECT_THAT(scores("footprint_entropy"), near(kBits));
}

TEST(AcquisitionValues, InsideIsTheStandardDeviationTimesTheProbabilityNotTimesTheWeight) {
  EXPECT_THAT(scores("object_uncertainty"), near({0.0, kDeep[1] * 0.25, kDeep[2] * 0.5, 0.0, kDeep[4] * 0.9}));
  EXPECT_THAT(scores("weighted"), near({0.1, 0.6, -0.06, 0.0, 0.0}));
}

TEST(AcquisitionValues, AMixtureIsTheSumOfItsPartsAndAScaleATimesItsPart) {
  const std::string parts =
      "{acquisitions: [{type: scale, factor: 0.7, acquisition: {type: footprint_entropy}}, "
      "{type: scale, factor: 0.3, acquisition: {type: object_uncertainty}}]}";
  EXPECT_THAT(scores("sum", parts), near({0.0, 0.7 * kBits[1] + 0.3 * kDeep[1] * 0.25, 0.7 + 0.3 * kDeep[2] * 0.5, 0.0,
                                          0.7 * kBits[4] + 0.3 * kDeep[4] * 0.9}));
  EXPECT_DOUBLE_EQ(scale_of("sum", parts), 1.0);
  EXPECT_THAT(scores("scale", "{factor: 2.5, acquisition: {type: uncertainty}}"), near({2.5, 1.25, 0.5, 0.0, 2.0}));
  EXPECT_DOUBLE_EQ(scale_of("scale", "{factor: 2.5, acquisition: {type: uncertainty}}"), 2.5);
}

}  // namespace
}  // namespace palpate::test
