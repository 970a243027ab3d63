// SPDX-License-Identifier: MIT
// Shipped configs, resolved: their ids, and what they refuse.
#include "record/resolved_config.hpp"

#include "config/yaml.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <boost/algorithm/string/replace.hpp>

#include <set>

namespace palpate::test {
namespace {

std::string id_of(const std::vector<std::string>& overrides = {}) {
  return shipped_config("paper/object_i.yaml", overrides).id;
}

TEST(ResolvedConfig, HasTheSameIdHoweverALengthIsWritten) {
  const std::string id = id_of({"kernel.length_scale=1.7cm"});
  for (const char* text :
       {"kernel.length_scale=17 mm", "kernel.length_scale=0.017m", "kernel.length_scale=+1.70e-2 m"}) {
    EXPECT_EQ(id_of({text}), id) << text;
  }
  EXPECT_NE(id_of({"kernel.length_scale=1.8cm"}), id);
}

TEST(ResolvedConfig, HasAnIdOfTwelveHexadecimalDigits) { EXPECT_THAT(id_of(), testing::MatchesRegex("[0-9a-f]{12}")); }

TEST(ResolvedConfig, HasTheSameIdWhenADefaultIsWrittenOut) {
  EXPECT_EQ(id_of({"choice.repeat=forbid", "belief.label.prior_mean=0", "motion.hover=13.5cm"}), id_of());
}

TEST(ResolvedConfig, LeavesNameAndLogOutOfTheId) {
  EXPECT_EQ(id_of({"name=other", "log.maps=true", "log.sync=none", "log.surface=false", "belief.engine.threads=2"}),
            id_of());
}

TEST(ResolvedConfig, PutsAllElseIntoTheId) {
  const std::string id = id_of();
  for (const char* text :
       {"seed=2", "taps=18", "initial.count=4", "candidates.count=46", "belief.height.noise=0.2mm",
        "belief.label.clip=true", "belief.engine.type=dense", "acquisition=uncertainty", "choice.fallback=none",
        "choice.repeat=allow", "choice.tie_tolerance=0", "stop.robot_time=9min", "scene.desk=1cm", "motion.pause=0s",
        "kernel=matern32", "kernel=swell_and_texture", "belief.surface=two_part",
        "belief.label.hyperparameters=shared"}) {
    EXPECT_NE(id_of({text}), id) << text;
  }
}

TEST(ResolvedConfig, ReadsBackAsTheSameConfig) {
  for (const char* file :
       {"paper/object_i.yaml", "paper/object_i_right.yaml", "paper/object_ii.yaml", "paper/comparison.yaml"}) {
    const ResolvedConfig config =
        shipped_config(file, {"belief.height.kernel=matern52", "belief.label.kernel=swell_and_texture",
                              "belief.surface=two_part", "candidates.spacing=5mm", "candidates.count=none"});
    const ResolvedConfig again = resolve_experiment(parse_yaml(to_yaml(config.tree), "again.yaml"), shared_host());
    EXPECT_EQ(again.id, config.id) << file;
    EXPECT_EQ(to_yaml(again.tree), to_yaml(config.tree)) << file;
  }
}

TEST(ResolvedConfig, DropsWhatTheCommandLinesPluginLacks) {
  const ResolvedConfig config =
      shipped_config("paper/object_i.yaml", {"acquisition=grid", "acquisition.type=weighted"});
  ASSERT_EQ(config.notes.dropped.size(), 1U);
  EXPECT_EQ(config.notes.dropped[0].path, "acquisition.count");
}

std::string refused_config(const std::vector<std::string>& overrides) {
  return error_of([&] { shipped_config("paper/object_i.yaml", overrides); });
}

/// The error of an experiment, without the place that a run gives it.
std::string refused_experiment(const std::vector<std::string>& overrides) {
  return error_of([&] { Prepared("paper/object_i.yaml", overrides); });
}

TEST(ResolvedConfig, RefusesATypoBesideAGroupChosenAtTheSameTime) {
  EXPECT_THAT(refused_config({"motion=paper", "motion.spede=3cm/s"}),
              testing::HasSubstr("unknown option 'spede', did you mean 'speed'?"));
  EXPECT_EQ(refused_config({"motion=paper", "motion.speed=3cm/s"}), "accepted");
}

TEST(ResolvedConfig, IsCompleteAndOneOfALaterVersionIsRefused) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  EXPECT_EQ(to_yaml(config.tree).substr(0, 12), "complete: 1\n");
  const auto trouble_with = [](const std::string& text) {
    return error_of([&] {
      Tree tree = parse_yaml(text, "config.yaml");
      mark_complete(tree);
      resolve_experiment(tree, shared_host());
    });
  };
  EXPECT_EQ(trouble_with("complete: 2\na_key_of_version_2: 3"),
            "config.yaml:1:11: complete: 2 is newer than 1, the latest version that this build reads, use a palpate at "
            "least as new as the one that wrote it");
  EXPECT_EQ(trouble_with("complete: 0").substr(0, 28), "config.yaml:1:11: complete: ");
}

TEST(ResolvedConfig, ThatIsCompleteTakesNeutralValuesForWhatItLacksAndIsRefusedWithoutOne) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  const auto read_without = [&](const char* group, const char* key) {
    Tree tree = parse_yaml(to_yaml(config.tree), "config.yaml");
    mark_complete(tree);
    tree.erase_path(std::string(group) + "." + key);
    return resolve_experiment(tree, shared_host());
  };
  EXPECT_EQ(read_without("candidates", "spacing").identity, config.identity);
  EXPECT_THAT(error_of([&] { read_without("belief.label", "clip"); }),
              testing::HasSubstr("'belief.label.clip' is missing, a config with 'complete' needs every option"));
}

TEST(ResolvedConfig, FollowsTheContentOfMeshesViewsAndProgramsAndNotTheirPaths) {
  const TemporaryFolder folder;
  for (const char* words :
       {"scene.objects=[{type: mesh, file: FILE, unit: 1 mm}]", "belief.prior={depth: FILE}",
        "backend={type: process, command: python3 FILE --fast}", "backend={type: process, command: FILE --fast}"}) {
    const auto id_with = [&](const std::string& name, const std::string& content) {
      const std::string file = folder.write(name, content).string();
      return id_of({boost::replace_all_copy(std::string(words), "FILE", file)});
    };
    const std::string id = id_with("one/a", "content");
    EXPECT_EQ(id_with("other/b", "content"), id) << words;
    EXPECT_NE(id_with("one/a", "other content"), id) << words;
  }
}

TEST(ResolvedConfig, RefusesAGridThatIsTooFineForAnyComputer) {
  EXPECT_EQ(refused_experiment({"candidates={spacing: 1 um, count: none}"}),
            "candidates.spacing: cuts the area into more than 2000 cells along a side, use larger cells");
  EXPECT_EQ(refused_experiment({"candidates.spacing=1e-300 m", "candidates.count=none"}).substr(0, 20),
            "candidates.spacing: ");
}

TEST(ResolvedConfig, RefusesMoreInitialTapsThanCandidates) {
  EXPECT_EQ(refused_experiment({"candidates.count=2", "initial.count=5"}),
            "initial.count: 5 taps, but there are only 4 candidates, use fewer initial taps or more "
            "candidates");
  EXPECT_EQ(refused_experiment({"candidates.count=2", "initial.count=4"}), "accepted");
}

TEST(ResolvedConfig, TakesASearchInPlaceOfCountedTaps) {
  EXPECT_EQ(refused_config({"initial.design=search"}), "accepted") << "the count of the config goes with its design";
  EXPECT_EQ(refused_config({"initial.design=search", "taps=1"}), "accepted") << "it ends when the budget does";
  EXPECT_EQ(refused_config({"initial.design=search", "initial.smallest=22.9 cm"}), "accepted");
  EXPECT_EQ(
      refused_config({"initial.design=search", "initial.smallest=23 cm"}),
      "command line: initial.smallest: is not smaller than the sides of the area, give the least width of the object");
  EXPECT_EQ(refused_config({"initial.smallest=1 cm"}),
            "command line: unknown option 'smallest' of initial, known: design, count");
}

TEST(Slug, IsTheNameOrPutsOneDashForAllElseAndEndsInAHash) {
  EXPECT_EQ(slug("Object_I-2.b"), "Object_I-2.b");
  EXPECT_THAT(slug("a /\\ b\nc"), testing::MatchesRegex("a-b-c~[0-9a-f]{6}"));
}

TEST(Slug, IsNeverEmptyHiddenLongOrAPath) {
  for (const char* const name : {"", "///", ".."})
    EXPECT_THAT(slug(name), testing::MatchesRegex("experiment~[0-9a-f]{6}"));
  EXPECT_THAT(slug("../../etc"), testing::MatchesRegex("etc~[0-9a-f]{6}"));
  EXPECT_THAT(slug(std::string(100, 'a')), testing::MatchesRegex("a{64}~[0-9a-f]{6}"));
}

TEST(Slug, OfOtherNamesIsAnother) {
  std::set<std::string> folders{slug(std::string(64, 'a')), slug(std::string(65, 'a'))};
  for (const char* const name :
       {"Tasse blau", "Tasse-blau", "Tasse  blau", "Tasse-blau-", " Tasse blau", "Schüssel", "Schässel", "Schssel",
        "茶碗", "花瓶", "", "experiment", "///", "..", "a/b", "a-b", "a\nb"})
    folders.insert(slug(name));
  EXPECT_EQ(folders.size(), 19U);
}

}  // namespace
}  // namespace palpate::test
