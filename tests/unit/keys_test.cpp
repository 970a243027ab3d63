// SPDX-License-Identifier: MIT
#include "config/keys.hpp"

#include "config/describe.hpp"
#include "experiment/experiment_options.hpp"
#include "support/testing.hpp"

#include <set>
#include <stdexcept>

namespace palpate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<FieldDescription> all_fields() {
  ExperimentOptions options;
  std::vector<FieldDescription> out = describe_fields([&](Fields& fields) { options.list(fields); });
  for (const Field& field : keys_beside_options()) out.push_back(describe_key(field));
  return out;
}

TEST(ConfigKeys, OfTheRunAreTheWorldTheBudgetAndWhatIsKeptAndAllElseIsAStrategys) {
  const std::set<std::string> of_run{"name", "seed",     "taps",   "candidates", "scene", "backend",
                                     "log",  "complete", "expect", "sweep",      "tune",  "compare"};
  std::set<std::string> found;
  for (const FieldDescription& field : all_fields()) {
    if (field.owner == Owner::run) found.insert(field.name);
  }
  EXPECT_EQ(found, of_run) << "whoever adds a key decides whether a strategy sets it, and says so here";
}

TEST(ConfigKeys, ThatSayNothingOfStrategiesAreRefused) {
  double radius = 0.0;
  try {
    const ConfigKeys keys([&](Fields& fields) { fields.real(radius, Field("radius", "of the world")); });
    FAIL() << "it was taken";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "the key 'radius' does not say whether it is of a strategy or of the run");
  }
}

TEST(ConfigKeys, KnowAPluginsGroupWhereverItStandsAndAnyOtherInItsPlaceAlone) {
  for (const char* path : {"kernel", "belief.height.kernel", "belief.footprint", "kernel.kernels.0.kernel", "backend",
                           "scene", "scene.effects", "strategy", "expect"}) {
    EXPECT_TRUE(config_keys().is_group(path)) << path;
  }
  for (const char* path :
       {"effects", "backend.scene", "kernel.strategy", "posterior", "scene.objects", "belief", "belief.height"}) {
    EXPECT_FALSE(config_keys().is_group(path)) << path;
  }
}

TEST(ConfigKeys, TellWhereAValueIsTakenOver) {
  EXPECT_THAT(config_keys().heirs_of("kernel.nu"), ElementsAre("belief.height.kernel.nu", "belief.label.kernel.nu"));
  EXPECT_THAT(config_keys().heirs_of("fitting"), ElementsAre("belief.height.fitting", "belief.label.fitting"));
  EXPECT_THAT(config_keys().heirs_of("kernels"), IsEmpty());
  EXPECT_THAT(config_keys().heirs_of("belief.height.kernel"), IsEmpty());
}

}  // namespace
}  // namespace palpate::test
