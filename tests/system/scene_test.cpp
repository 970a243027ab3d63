// SPDX-License-Identifier: MIT
// The shipped scenes and meshes as a user meets them: on the command line.
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Scenes, ThatAreShippedRunWithinThePapersBudget) {
  const test::TemporaryFolder folder;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "configs/scene")) {
    if (entry.path().extension() != ".yaml") continue;
    // From the folder of the sources, where the path of the shipped mesh starts.
    const test::Ended ended = test::palpate(
        {"run", test::paper(), "scene=" + entry.path().stem().string(), "--quiet", "--runs", folder.path().string()},
        test::source_folder());
    EXPECT_EQ(ended.status, 0) << entry.path() << ended.err;
  }
}

TEST(Scenes, WithAMeshThatIsBrokenAreRefusedInOneLineByEveryCommand) {
  const test::TemporaryFolder folder;
  folder.write("broken.stl", "solid broken\n facet normal 0 0 1\n");
  const fs::path config = folder.write(
      "e.yaml",
      "name: e\ndefaults: [{kernel: rbf}, {acquisition: weighted}, {backend: simulator}]\n"
      "scene:\n  area: {width: 23 cm, depth: 23 cm}\n  objects: [{type: mesh, file: broken.stl, unit: 1 mm}]\n");
  for (const char* command : {"validate", "run"}) {
    const test::Ended ended = test::palpate({command, "e.yaml"}, folder.path());
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.err, "broken.stl: is cut short: the word 'endsolid' is missing, export it again\n");
  }
  EXPECT_FALSE(fs::exists(folder.path() / "runs")) << "nothing was begun";
  fs::remove(folder.path() / "broken.stl");
  const test::Ended missing = test::palpate({"run", "e.yaml"}, folder.path());
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, StartsWith("broken.stl: no such file, a relative path starts in the current folder, "));
  EXPECT_EQ(test::lines(missing.err), 1);
}

TEST(Scenes, NameTheLibraryOfAMeshInTheManifest) {
  const test::TemporaryFolder folder;
  const std::string file = (test::source_folder() / "configs/scene/meshes/cup.stl").string();
  const test::Ended ended =
      test::palpate({"run", test::paper(), "scene=cup", "scene.objects.0.file=" + file, "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const fs::path run = test::only_run(folder.path() / "runs");
  EXPECT_THAT(test::text_of(run / "manifest.json"), HasSubstr("shape/mesh.so"));
  EXPECT_THAT(test::text_of(run / "config.yaml"), HasSubstr("checksum: "));
}

TEST(Scenes, HaveTheOptionsOfMeshesInPluginsAndSchema) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::palpate({"plugins", "shape/mesh"}, folder.path()).out, HasSubstr("  unit      length > 0 m"));
  const std::string schema = test::palpate({"schema"}, folder.path()).out;
  for (const char* field : {"\"checksum\"", "\"outline\"", "\"tilt\""}) EXPECT_THAT(schema, HasSubstr(field));
}

}  // namespace
}  // namespace palpate
