// SPDX-License-Identifier: MIT
// The two groups that are more than one option: a strategy, and a set of effects.
#include "support/runs.hpp"
#include "unit/compose_fixture.hpp"

namespace palpate::test {
namespace {

class ComposeStrategy : public test::ComposeFixture {
 protected:
  ComposeStrategy() {
    folder_.write("scene/desk.yaml", "scene: {desk: 0 cm, effects: {reach: {radius: 1 m}}}\n");
    folder_.write("effects/noisy.yaml", "effects: {force_noise: {deviation: 1 N}}\n");
    folder_.write("effects/none.yaml", "effects: {}\n");
    folder_.write("strategy/bold.yaml",
                  "defaults:\n  - kernel: rough\n  - acquisition: weighted\n"
                  "kernel: {length_scale: 4 cm}\nbelief: {surface: two_part}\ntaps: 99\nscene: {desk: 5 cm}\n");
    folder_.write("strategy/bolder.yaml", "defaults:\n  - strategy: bold\nkernel: {length_scale: 6 cm}\n");
  }

  static std::string of(const std::string& written) { return parse_value(written, "").canonical(); }
};

TEST_F(ComposeStrategy, LiesBelowAllThatTheConfigSays) {
  const std::string text = "defaults:\n  - strategy: bold\n";
  EXPECT_EQ(value(text, "kernel.length_scale"), "4 cm");
  EXPECT_EQ(value(text, "kernel.nu"), "1.5");
  EXPECT_EQ(value(text, "acquisition.type"), "weighted");
  EXPECT_EQ(value(text + "belief: {surface: single}\n", "belief.surface"), "single");
  EXPECT_EQ(value("strategy: bold\nkernel: {length_scale: 9 cm}\n", "kernel.length_scale"), "9 cm");
  EXPECT_EQ(value("defaults:\n  - kernel: rbf\n  - strategy: bold\n", "kernel.type"), "rbf")
      << "wherever it stands among the defaults";
}

TEST_F(ComposeStrategy, HasNoSayInTheWorldAndTheBudget) {
  EXPECT_EQ(value("strategy: bold\n", "taps"), "-");
  EXPECT_EQ(value("strategy: bold\n", "scene"), "-");
  EXPECT_EQ(value("strategy: bold\n", "strategy"), "-") << "the name itself is no option";
}

TEST_F(ComposeStrategy, BuildsOnAnother) {
  EXPECT_EQ(value("strategy: bolder\n", "kernel.length_scale"), "6 cm");
  EXPECT_EQ(value("strategy: bolder\n", "kernel.nu"), "1.5");
  EXPECT_EQ(value("strategy: bolder\n", "belief.surface"), "two_part");
}

TEST_F(ComposeStrategy, AsAnOverrideTakesThePlaceOfEveryKeyThatItHas) {
  const std::string text =
      "defaults:\n  - kernel: rbf\n  - fitting: ceres\nkernel: {length_scale: 1 cm, alpha: 3}\n"
      "belief: {surface: single}\nchoice: {repeat: allow}\ntaps: 5\n";
  const std::vector<std::string> bold{"strategy=bold"};
  EXPECT_EQ(value(text, "kernel", bold), of("{type: matern, length_scale: 4 cm, nu: 1.5}"));
  EXPECT_EQ(value(text, "belief.surface", bold), "two_part");
  EXPECT_EQ(value(text, "choice.repeat", bold), "allow") << "of which it says nothing";
  EXPECT_EQ(value(text, "fitting.type", bold), "ceres");
  EXPECT_EQ(value(text, "taps", bold), "5");
  EXPECT_EQ(value("strategy: bolder\n", "kernel.length_scale", bold), "4 cm");
}

TEST_F(ComposeStrategy, AsAnOverrideTakesThePlaceOfAWholeBeliefOfAnotherType) {
  folder_.write("strategy/around.yaml", "belief: {type: solids, particles: 9}\n");
  const std::string vertical = "defaults:\n  - belief.footprint: primitives\nbelief: {height: {noise: 6 mm}}\n";
  EXPECT_EQ(value(vertical, "belief", {"strategy=around"}), of("{type: solids, particles: 9}"));
  EXPECT_EQ(value("belief: {type: solids, moves: 7}\n", "belief", {"strategy=around"}),
            of("{type: solids, particles: 9, moves: 7}"));
  EXPECT_EQ(value("belief: {type: solids, moves: 7}\n", "belief", {"strategy=bold"}), of("{surface: two_part}"));
  EXPECT_EQ(value("belief: solids\n", "belief", {"strategy=bold"}), of("{surface: two_part}"));
}

TEST(ComposedStrategy, MayReplaceTheBeliefOfEachShippedConfig) {
  for (const char* const config : {"default", "any_side", "paper/object_i"}) {
    for (const char* const strategy : {"default", "any_side", "grid", "random", "uncertainty", "weighted"}) {
      Composer composer(source_folder() / "configs", config_keys());
      const Tree tree = composer.compose(source_folder() / "configs" / (std::string(config) + ".yaml"),
                                         {parse_override(std::string("strategy=") + strategy)});
      const ResolvedConfig resolved = resolve_experiment(tree, shared_host());
      EXPECT_EQ(resolved.options.belief.type, strategy == std::string("any_side") ? "solids" : "height_map") << config;
    }
  }
}

TEST_F(ComposeStrategy, GivesWayToWhatIsSaidBesideIt) {
  EXPECT_EQ(value("", "kernel.type", {"strategy=bold", "kernel=rbf"}), "rbf");
  EXPECT_EQ(value("", "kernel.length_scale", {"kernel.length_scale=2cm", "strategy=bold"}), "2cm");
}

TEST_F(ComposeStrategy, MayBeAWholeConfig) {
  folder_.write("whole.yaml",
                "name: whole\nseed: 3\ndefaults:\n  - scene: desk\n  - kernel: rough\nsweep: {grid: {seed: 1}}\n");
  EXPECT_EQ(value("strategy: whole\n", "kernel.nu"), "1.5");
  for (const char* key : {"name", "seed", "scene", "sweep"}) EXPECT_EQ(value("strategy: whole\n", key), "-") << key;
  EXPECT_EQ(refusal("strategy: wohle\n"), "c.yaml:1:11: no file strategy/wohle.yaml, did you mean 'whole'?");
}

TEST_F(ComposeStrategy, BringsAMotionWhereNobodyElseSaysOneAndNeverAPartOfOne) {
  folder_.write("strategy/quick.yaml", "backend: process\nmotion: {type: continuous, speed: 20 cm/s, brake: 3 cm}\n");
  folder_.write("strategy/quicker.yaml",
                "defaults:\n  - strategy: quick\nmotion: {type: continuous, speed: 30 cm/s}\n");
  folder_.write("backend/arm.yaml", "backend: {type: baxter}\nmotion: {type: continuous, speed: 1 cm/s}\n");
  folder_.write("backend/bare.yaml", "backend: {type: simulator}\n");
  const auto motion = [&](const std::string& text, const std::vector<std::string>& words = {}) {
    return value(text, "motion", words);
  };
  EXPECT_EQ(value("strategy: quick\nbackend: bare\n", "backend.type"), "simulator") << "the backend is the run's";
  const std::string quick = of("{type: continuous, speed: 20 cm/s, brake: 3 cm}");
  EXPECT_EQ(motion("strategy: quick\nbackend: bare\n"), quick);
  EXPECT_EQ(motion("backend: bare\n", {"strategy=quick"}), quick);
  EXPECT_EQ(motion("strategy: quicker\nbackend: bare\n"), of("{type: continuous, speed: 30 cm/s}"));
  const std::string slow = of("{type: continuous, speed: 1 cm/s}");
  EXPECT_EQ(motion("strategy: quick\nbackend: arm\n"), slow);
  EXPECT_EQ(motion("backend: arm\n", {"strategy=quick"}), slow);
  EXPECT_EQ(motion("defaults:\n  - strategy: quick\nbackend: {type: baxter}\nmotion: {speed: 1 cm/s}\n"),
            of("{speed: 1 cm/s}"));
  EXPECT_EQ(motion("strategy: quick\nbackend: bare\n", {"motion.speed=2cm/s"}),
            of("{type: continuous, speed: 2cm/s, brake: 3 cm}"))
      << "a person may";
  EXPECT_TRUE(config_keys().is_of_strategy("motion.speed"));
  EXPECT_FALSE(config_keys().is_of_strategy("backend.pace"));
}

TEST_F(ComposeStrategy, ABackendBringsItsMotionUnlessThatIsChosenAsLate) {
  folder_.write("backend/arm.yaml", "backend: {type: baxter}\nmotion: {type: continuous, speed: 1 cm/s}\n");
  folder_.write("backend/other.yaml", "defaults:\n  - backend: arm\nbackend: {dry_run: true}\n");
  folder_.write("motion/steps.yaml", "motion: {type: paper, step: 1 cm}\n");
  const std::string both = "defaults:\n  - backend: simulator\n  - motion: steps\n";
  const std::string steps = of("{type: paper, step: 1 cm}");
  const std::string slow = of("{type: continuous, speed: 1 cm/s}");
  EXPECT_EQ(value(both, "motion"), steps);
  for (const char* arm : {"backend=arm", "backend=other"}) {
    EXPECT_EQ(value(both, "motion", {arm}), slow) << "no arm moves as a simulated one did";
    EXPECT_EQ(value(both, "motion", {arm, "motion=steps"}), steps);
    EXPECT_EQ(value(both, "motion", {"motion=steps", arm}), steps);
  }
  EXPECT_EQ(value(both, "motion", {"backend=arm", "motion.speed=2cm/s"}), of("{type: continuous, speed: 2cm/s}"));
  EXPECT_EQ(value("defaults:\n  - motion: steps\n  - backend: arm\n", "motion"), steps);
  EXPECT_EQ(value("defaults:\n  - backend: arm\nmotion: {speed: 3 cm/s}\n", "motion"),
            of("{type: continuous, speed: 3 cm/s}"));
  EXPECT_EQ(value("defaults:\n  - motion: steps\nbackend: arm\n", "motion"), steps) << "wherever the file says so";
}

TEST_F(ComposeStrategy, AMotionThatABackendReplacesIsNoLongerAGroupOfTheConfig) {
  folder_.write("backend/arm.yaml", "backend: {type: baxter}\nmotion: {type: continuous, speed: 1 cm/s}\n");
  folder_.write("motion/steps.yaml", "motion: {type: paper, step: 1 cm}\n");
  const fs::path file = folder_.write("c.yaml", "defaults:\n  - backend: simulator\n  - motion: steps\n");
  Composer composer("/nonexistent", config_keys());
  composer.compose(file, {parse_override("backend=arm")});
  std::vector<std::string> paths;
  for (const Composer::Group& one : composer.groups()) paths.push_back(one.path);
  EXPECT_EQ(paths, std::vector<std::string>{"backend"});
}

TEST(ComposedStrategy, LeavesNoOptionOfItsBeliefToTheBeliefThatTheConfigNames) {
  const TemporaryFolder folder;
  const auto file = folder.write("c.yaml",
                                 "strategy: uncertainty\nscene: object_i\nbackend: simulator\n"
                                 "belief: {type: nearest_neighbour, reach: 3 cm}\n");
  Composer composer(source_folder() / "configs", config_keys());
  const ResolvedConfig config = resolve_experiment(composer.compose(file, {}), shared_host());
  EXPECT_EQ(config.options.belief.type, "nearest_neighbour");
  EXPECT_EQ(belief_option(config.options, "footprint.type"), "");
}

TEST_F(ComposeStrategy, IsTheOneOfItsFolderEvenForAConfigOfThatName) {
  folder_.write("bold.yaml", "strategy: bold\nbelief: {surface: single}\n");
  EXPECT_EQ(value("strategy: bold\n", "kernel.nu"), "1.5");
  EXPECT_EQ(value("strategy: bold\n", "belief.surface"), "two_part");
}

TEST_F(ComposeStrategy, RefusesAnUnknownOneAndACycle) {
  EXPECT_EQ(refusal("strategy: bald\n"), "c.yaml:1:11: no file strategy/bald.yaml, did you mean 'bold'?");
  EXPECT_EQ(refusal("", {"strategy=../x"}),
            "command line: '../x' is not a valid name in the group strategy, a name has letters, digits, '_' and '-', "
            "and no path");
  folder_.write("strategy/egg.yaml", "strategy: hen\n");
  folder_.write("strategy/hen.yaml", "strategy: egg\n");
  EXPECT_EQ(refusal("strategy: hen\n"),
            "strategy/egg.yaml:1:11: defaults form a cycle, strategy/hen -> strategy/egg -> strategy/hen");
}

TEST_F(ComposeStrategy, DecidesWhatIsNotOfTheWorld) {
  EXPECT_TRUE(config_keys().is_of_strategy("kernel.length_scale"));
  EXPECT_TRUE(config_keys().is_of_strategy("initial.count"));
  EXPECT_FALSE(config_keys().is_of_strategy("scene.effects"));
  EXPECT_FALSE(config_keys().is_of_strategy("taps"));
}

TEST_F(ComposeStrategy, EffectsTakeThePlaceOfThoseOfTheScene) {
  const std::string text = "defaults:\n  - scene: desk\n";
  EXPECT_EQ(value(text, "scene.effects"), of("{reach: {radius: 1 m}}"));
  EXPECT_EQ(value(text, "scene.effects", {"scene.effects=noisy"}), of("{force_noise: {deviation: 1 N}}"));
  EXPECT_EQ(value(text, "scene.effects", {"scene.effects=none"}), of("{}"));
  EXPECT_EQ(value(text + "scene: {effects: noisy}\n", "scene.effects"), of("{force_noise: {deviation: 1 N}}"));
  EXPECT_EQ(value("defaults:\n  - scene.effects: noisy\n  - scene: desk\n", "scene.effects"),
            of("{force_noise: {deviation: 1 N}}"));
  EXPECT_EQ(value(text, "scene.effects", {"scene.effects={}"}), of("{}")) << "a map takes their place, too";
  EXPECT_EQ(refusal(text, {"scene.effects=nosy"}), "command line: no file effects/nosy.yaml, did you mean 'noisy'?");
}

}  // namespace
}  // namespace palpate::test
