// SPDX-License-Identifier: MIT
// Groups of options that may be absent, by the example that they exist for: the effects of a scene.
#include "scene/scene_options.hpp"

#include "config/describe.hpp"
#include "config/resolve.hpp"
#include "config/yaml.hpp"
#include "tapping_bench.hpp"

namespace palpate::test {
namespace {

Effects effects(const std::string& yaml) { return test::filled<EffectOptions>(yaml).values; }

std::string effect_refusal(const std::string& yaml) {
  return error_of([&] { effects(yaml); });
}

std::string resolved(const std::string& yaml) {
  EffectOptions options;
  ResolveNotes notes;
  return to_yaml(resolve(options, parse_yaml(yaml, "options.yaml"), test::shared_host(), notes));
}

TEST(OptionalGroups, AreAbsentUntilTheyAreWrittenAndTakenAwayByNone) {
  EXPECT_FALSE(effects("{joint_lag: none}").joint_lag);
  const Effects none = effects("{}");
  EXPECT_FALSE(none.joint_lag);
  EXPECT_FALSE(none.reach);
  const Effects some = effects("{joint_lag: {}, stiffness: {arm: 2 kN/m, object: 3 N/mm}}");
  ASSERT_TRUE(some.joint_lag);
  EXPECT_DOUBLE_EQ(some.joint_lag->delay, 0.35);
  ASSERT_TRUE(some.stiffness);
  EXPECT_DOUBLE_EQ(some.stiffness->object, 3000.0);
  EXPECT_DOUBLE_EQ(some.stiffness->arm.value(), 2000.0);
  EXPECT_FALSE(some.force_noise);
}

TEST(OptionalGroups, WriteNothingWhereTheyAreAbsentAndReadBackWhereNot) {
  EXPECT_EQ(resolved("{}"), "{}\n");
  const std::string text = resolved("{tip_radius: {}}");
  EXPECT_EQ(text, "tip_radius:\n  radius: 0.005 m\n");
  EXPECT_EQ(resolved(text), text);
}

TEST(OptionalGroups, RefuseWhatIsNoGroupInOneLine) {
  EXPECT_EQ(effect_refusal("{joint_lag: }"),
            "options.yaml:1:2: joint_lag has no value, write {} for its defaults, or none");
  EXPECT_THAT(effect_refusal("{joint_lag: 350 ms}"), testing::HasSubstr("joint_lag is not a group of options"));
  EXPECT_THAT(effect_refusal("{joint_lag: {delay: 350}}"), testing::HasSubstr("joint_lag.delay: '350' has no unit"));
  EXPECT_THAT(effect_refusal("{joint_lag: {dely: 350 ms}}"), testing::HasSubstr("did you mean 'delay'?"));
  EXPECT_THAT(effect_refusal("{joint_lagg: {}}"), testing::HasSubstr("did you mean 'joint_lag'?"));
}

TEST(OptionalGroups, AreDescribedAsAbsentAndEveryEffectSaysWhereItsSizeComesFrom) {
  EffectOptions options;
  const auto fields = describe_fields([&](Fields& list) { options.list(list); });
  ASSERT_EQ(fields.size(), 14u);
  for (const FieldDescription& effect : fields) {
    EXPECT_TRUE(effect.optional) << effect.name;
    for (const FieldDescription& field : effect.fields) {
      if (field.default_value == "none") continue;
      EXPECT_NE(field.source, "") << effect.name << "." << field.name;
    }
  }
  EXPECT_THAT(describe_text(fields), testing::ContainsRegex("joint_lag +group +absent"));
}

}  // namespace
}  // namespace palpate::test
