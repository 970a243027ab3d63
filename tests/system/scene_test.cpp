// SPDX-License-Identifier: MIT
// The shipped scenes and meshes as a user meets them: on the command line.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using Scenes = Shell;

TEST_F(Scenes, ThatAreShippedRunWithinThePapersBudget) {
  int number = 0;
  for (const auto& entry : fs::directory_iterator(config("scene"))) {
    if (entry.path().extension() != ".yaml") continue;
    if (test::kSanitized && number++ % 4 != 0) continue;  // any of them: what they run is the same
    const std::string name = entry.path().stem().string();
    const bool any_side = name.compare(0, 4, "any_") == 0;
    // From the folder of the sources, where the path of the shipped mesh starts.
    Words words{"run",          any_side ? config("any_side.yaml") : paper(), "scene=" + name, "--quiet", "--runs",
                here().string()};
    if (any_side) words = words + "taps=6 belief.moves=50";
    const Ended ended = test::palpate(words, test::source_folder());
    EXPECT_EQ(ended.status, 0) << entry.path() << ended.err;
  }
}

TEST_F(Scenes, WithAMeshThatIsBrokenAreRefusedInOneLineByEveryCommand) {
  write("broken.stl", "solid broken\n facet normal 0 0 1\n");
  write("e.yaml",
        "name: e\ndefaults: [{kernel: rbf}, {acquisition: weighted}, {backend: simulator}]\n"
        "scene:\n  area: {width: 23 cm, depth: 23 cm}\n  objects: [{type: mesh, file: broken.stl, unit: 1 mm}]\n");
  for (const char* command : {"validate", "run"}) {
    EXPECT_EQ(refused({command, "e.yaml"}),
              "broken.stl: is cut short: the word 'endsolid' is missing, export it again\n");
  }
  EXPECT_TRUE(left_nothing()) << "nothing was begun";
  fs::remove(here() / "broken.stl");
  EXPECT_THAT(refused("run e.yaml"), StartsWith("e.yaml:5:32: scene.objects.0.file: broken.stl: no such file, a "
                                                "relative path starts in the current folder, "));
}

TEST_F(Scenes, WithAnObjectWhoseSizeIsSaidInPartSayWhatTheRestIs) {
  const auto said_of = [&](const std::string& objects) {
    write("e.yaml",
          "name: e\ndefaults: [{kernel: rbf}, {acquisition: weighted}, {backend: simulator}]\n"
          "scene:\n  area: {width: 23 cm, depth: 23 cm}\n  objects: " +
              objects + "\n");
    const Ended ended = palpate("validate e.yaml");
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended.err;
  };
  EXPECT_EQ(said_of("[{type: block, length: 6 cm, width: 5 cm}]"),
            "e.yaml:5:20: scene.objects.0: not given, so the default is used: height 5 cm\n");
  EXPECT_EQ(said_of("[{type: compound, parts: [{type: cone, height: 4 cm}]}]"),
            "e.yaml:5:45: scene.objects.0.parts.0: not given, so the default is used: diameter 12 cm\n");
  EXPECT_EQ(said_of("[{type: block}, {type: block, length: 6 cm, width: 5 cm, height: 2 cm}]"), "");
}

TEST_F(Scenes, FindTheirMeshFromAnyWorkingFolderAndSoDoesTheirRecord) {
  const fs::path shipped = ran({"scene=cup"});
  write("mine/configs/own.stl", text_of(test::source_folder() / "configs/scene/meshes/cup.stl"));
  write("mine/e.yaml",
        "name: own\ndefaults: [{kernel: rbf}, {acquisition: weighted}, {backend: simulator}]\n"
        "scene:\n  area: {width: 23 cm, depth: 23 cm}\n"
        "  objects: [{type: mesh, file: configs/own.stl, unit: 1 mm}]\n");
  EXPECT_EQ(palpate("run mine/e.yaml taps=4 --quiet").status, 0);
  fs::create_directories(here() / "elsewhere");
  for (const fs::path& run : {shipped, fs::directory_iterator(here() / "runs/own")->path()}) {
    const Ended again = test::palpate({"replay", fs::absolute(run).string()}, here() / "elsewhere");
    EXPECT_EQ(again.status, 0) << again.err;
  }
}

TEST_F(Scenes, NameTheLibraryOfAMeshInTheManifest) {
  const fs::path run = ran({"scene=cup", "scene.objects.0.file=" + config("scene/meshes/cup.stl")});
  EXPECT_THAT(part_of(run, "manifest"), HasSubstr("shape/mesh.so"));
  EXPECT_THAT(text_of(run / "config.yaml"), HasSubstr("checksum: "));
}

TEST_F(Scenes, HaveTheOptionsOfMeshesInPluginsAndSchema) {
  EXPECT_THAT(palpate("plugins shape/mesh").out, HasSubstr("  unit      length > 0 m"));
  EXPECT_THAT(palpate("schema").out, AllOf(HasSubstr("\"checksum\""), HasSubstr("\"outline\""), HasSubstr("\"tilt\"")));
}

}  // namespace
}  // namespace palpate
