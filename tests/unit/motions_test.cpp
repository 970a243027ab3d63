// SPDX-License-Identifier: MIT
// Several motions of one arm, of which a tap takes one.
#include "tapping_bench.hpp"

namespace palpate::test {
namespace {

constexpr const char* kTrailing = "{stiffness: {object: 1500 N/m}, joint_lag: {delay: 350 ms}}";

TEST(Motions, OfTheSimulatorAreThoseThatAreAskedFor) {
  const char* several =
      "{type: per_tap, of: [{type: paper}, {type: continuous, speed: 6 cm/s}, {type: continuous, speed: 3 cm/s}]}";
  const char* alone[] = {"{type: paper}", "{type: continuous, speed: 6 cm/s}", "{type: continuous, speed: 3 cm/s}"};
  for (const char* effects : {"{}", kTrailing}) {
    const TappingBench all(kObjectI, effects, several);
    for (int motion = 0; motion < 3; ++motion) {
      TapRequest request = request_at({0.1, 0.1});
      request.predicted = Prediction{0.05, 0.01, 0.5};
      const TappingBench one(kObjectI, effects, alone[motion]);
      const TapResult expected = one.backend().tap(request);
      request.motion = motion;
      expect_same(all.backend().tap(request), expected);
    }
  }
}

TEST(Motions, TellWhatATapTakesOnAPerfectArm) {
  const auto choice = choose(shared_host(), "backend", "simulator",
                             "{motion: {type: per_tap, of: [{type: paper}, {type: two_stage}, {type: continuous}, "
                             "{type: continuous, adaptive_hover: {certainty: 0.9}}]}}");
  const TappingBench bench(kObjectI, "{}", "{type: paper}");
  const auto motions = shared_host().motions(choice, bench.scene());
  ASSERT_NE(motions, nullptr);
  ASSERT_EQ(motions->count(), 4);
  const Context context{shared_host(), bench.scene(), 1, nullptr};
  const auto backend = context.create<Backend>(choice);
  Random random(5, "places");
  for (int i = 1; i <= 50; ++i) {
    TapRequest request = request_at({0.23 * random.uniform(), 0.23 * random.uniform()}, i);
    request.previous = line_from_above({0.1, 0.2});
    request.predicted = Prediction{0.06, 0.01, random.uniform()};
    for (request.motion = 0; request.motion < 4; ++request.motion) {
      const TapResult contact = backend->tap(request);
      EXPECT_NEAR(motions->seconds(request, contact.height()), contact.seconds, 1e-12);
    }
  }
  EXPECT_GT(motions->deviation(2), 0.0);
  EXPECT_EQ(
      shared_host().motions(choose(shared_host(), "backend", "simulator", "{motion: {type: paper}}"), bench.scene()),
      nullptr);
  EXPECT_EQ(shared_host().motions(choose(shared_host(), "backend", "replay", "{record: x}"), bench.scene()), nullptr);
}

TEST(Motions, OfWhichThereIsNoChoiceAreRefused) {
  const auto refusal = [](const std::string& motion) {
    return error_of([&] { choose(shared_host(), "backend", "simulator", "{motion: " + motion + "}"); });
  };
  EXPECT_NE(refusal("{type: per_tap, of: [{type: paper}]}").find("at least two"), std::string::npos);
  EXPECT_NE(refusal("{type: per_tap, of: [{type: paper}, {type: paper, hover: 20 cm}]}").find("same hover"),
            std::string::npos);
  EXPECT_NE(refusal("{type: per_tap, of: [{type: paper}, {type: per_tap}]}").find("per_tap"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test
