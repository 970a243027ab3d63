// SPDX-License-Identifier: MIT
// The laws of backend.hpp, over every backend found that can be made without further options and whose taps can be
// repeated: a test never moves a robot.
#include "support/testing.hpp"

#include <palpate/backend.hpp>

namespace palpate::test {
namespace {

/// Every tap of a short run over the area, its corners included.
std::vector<TapRequest> requests() {
  std::vector<TapRequest> out;
  const Area area = wave_scene().area();
  for (const double x : {0.0, 0.3, 0.5, 1.0}) {
    for (const double y : {0.0, 0.5, 0.8, 1.0}) {
      TapRequest request;
      request.number = static_cast<int>(out.size()) + 1;
      request.line = line_from_above({x * area.width, y * area.depth});
      if (!out.empty()) request.previous = out.back().line;
      out.push_back(request);
    }
  }
  return out;
}

void expect_same(const TapResult& a, const TapResult& b) {
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_TRUE(a.contact == b.contact);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.reason, b.reason);
}

TEST(BackendContracts, CheckAtLeastTheSimulator) {
  // The cases below skip what they cannot build or must not repeat: here that would be a failure.
  EXPECT_TRUE(make<Backend>(contract_host(), "simulator")->repeatable());
}

class BackendContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    try {
      backend_ = make<Backend>(contract_host(), GetParam());
    } catch (const Error& refusal) {
      // Options without default, or a robot that is not there: such a backend has tests of its own.
      GTEST_SKIP() << refusal.what();
    }
    if (!backend_->repeatable()) GTEST_SKIP() << "its taps cannot be repeated";
  }

  std::shared_ptr<Backend> backend_;
};

TEST_P(BackendContract, FailsByOutcomeAndNeverByNumber) {
  for (const TapRequest& request : requests()) {
    const TapResult contact = backend_->tap(request);
    EXPECT_TRUE(std::isfinite(contact.seconds));
    EXPECT_GE(contact.seconds, 0.0);
    EXPECT_EQ(contact.reason.find('\n'), std::string::npos);
    if (contact.outcome == Outcome::contact) {
      ASSERT_TRUE(contact.contact);
      EXPECT_TRUE(contact.contact->allFinite());
      EXPECT_TRUE(std::isfinite(contact.force));
      EXPECT_EQ(contact.reason, "");
    } else {
      EXPECT_NE(contact.reason, "");
      EXPECT_FALSE(contact.contact);
    }
  }
}

TEST_P(BackendContract, AnswersTheSameRequestAlikeWhateverCameBefore) {
  const std::vector<TapRequest> all = requests();
  std::vector<TapResult> first;
  for (const TapRequest& request : all) first.push_back(backend_->tap(request));
  const std::shared_ptr<Backend> fresh = make<Backend>(contract_host(), GetParam());
  for (std::size_t i = all.size(); i-- > 0;) {
    expect_same(backend_->tap(all[i]), first[i]);
    expect_same(fresh->tap(all[i]), first[i]);
  }
}

TEST_P(BackendContract, AnswersAlikeWhetherItWasAskedToDescribeTheTapOrNot) {
  const std::shared_ptr<Backend> fresh = make<Backend>(contract_host(), GetParam());
  for (const TapRequest& request : requests()) {
    for (const std::string& line : backend_->describe(request)) EXPECT_EQ(line.find('\n'), std::string::npos);
    expect_same(backend_->tap(request), fresh->tap(request));
  }
}

TEST_P(BackendContract, TouchesTheSceneThatItCallsTheTruth) {
  if (!backend_->scene_is_truth()) return;
  for (const TapRequest& request : requests()) {
    const TapResult contact = backend_->tap(request);
    ASSERT_EQ(contact.outcome, Outcome::contact);
    // Without effects that a config would have to ask for, the answer is exact up to the rounding of a subtraction.
    const Target target = request.line.target();
    EXPECT_NEAR(contact.height(), wave_scene().height(target.x, target.y), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, BackendContract, testing::ValuesIn(plugins_under_contract("backend")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
