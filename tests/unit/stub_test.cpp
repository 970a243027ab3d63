// SPDX-License-Identifier: MIT
// Plugins of a build that has not found their libraries.
#include "config/compose.hpp"
#include "config/describe.hpp"
#include "experiment/experiment.hpp"
#include "record/resolved_config.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <array>
#include <sstream>

namespace palpate::test {
namespace {

/// The plugins of this build, but of those that need a library the ones that stand in their place without it.
class WithoutLibraries : public InFolder {
 protected:
  WithoutLibraries() {
    for (const fs::path& tree : {test::bad_plugin_folder("absent"), test::plugin_folder()}) {
      for (const auto& file : fs::recursive_directory_iterator(tree)) {
        const fs::path link = folder_.path() / "plugins" / fs::relative(file, tree);
        if (file.is_directory()) {
          fs::create_directories(link);
        } else if (!fs::exists(link)) {
          fs::create_symlink(file, link);
        }
      }
    }
  }

  /// The paper's first experiment with overrides, as such a build resolves it.
  ResolvedConfig resolved(const std::vector<Override>& overrides) const {
    const fs::path configs = source_folder() / "configs";
    Composer composer(configs, config_keys());
    return resolve_experiment(composer.compose(configs / "paper" / "object_i.yaml", overrides), host_);
  }

  const PluginHost host_{std::vector<fs::path>{folder_.path() / "plugins"}};
};

/// The packages under a heading of packages.txt, blanks between them.
std::string packages(const std::string& wanted) {
  std::istringstream lines(test::text_of(test::source_folder() / "packages.txt"));
  std::string line, heading, out;
  while (std::getline(lines, line)) {
    line = line.substr(0, line.find_first_of(" #"));
    if (!line.empty() && line.front() == '[') {
      heading = line;
    } else if (!line.empty() && heading == "[" + wanted + "]") {
      out += (out.empty() ? "" : " ") + line;
    }
  }
  return out;
}

/// The line that says what to install.
std::string remedy(const std::string& library, const std::string& names) {
  return "this build has no " + library + "; 'sudo apt-get install --no-install-recommends " + names +
         "' installs it, then build again; ./palpate does both";
}

TEST_F(WithoutLibraries, ARunIsToldWhatToInstallAndNotFirstWhatItsConfigLacks) {
  ASSERT_NE(packages("ros"), "");
  const std::string ceres = "libceres-dev";
  const std::string mesh = "libembree-dev libassimp-dev";
  for (const std::string& name : {ceres, mesh.substr(0, mesh.find(' ')), mesh.substr(mesh.find(' ') + 1)}) {
    EXPECT_THAT(" " + packages("core") + " ", ::testing::HasSubstr(" " + name + " "));
  }
  const fs::path file = folder_.write("wedge.stl", "solid wedge\nendsolid wedge\n");
  const std::vector<std::array<std::string, 2>> cases{
      {"backend=baxter", "backend/baxter: " + remedy("ROS 1", packages("ros"))},
      {"backend=fake_baxter", "backend/baxter: " + remedy("ROS 1", packages("ros"))},
      {"fitting=ceres", "fitting/ceres: " + remedy("Ceres", ceres)},
      {"scene.objects=[{type: mesh, file: " + file.string() + ", unit: 1mm, at: [11cm, 11cm]}]",
       "shape/mesh: " + remedy("Embree or no assimp", mesh)}};
  for (const auto& [override, words] : cases) {
    const auto build = [&, &override = override] { Experiment(resolved({parse_override(override)}).options, {host_}); };
    EXPECT_THAT(error_of(build, Error::Kind::usage), testing::EndsWith(words)) << override;
  }
}

TEST_F(WithoutLibraries, WhatWasRecordedElsewhereHasTheSameConfigAndId) {
  // So what a robot recorded can be replayed, compared and drawn at a desk without ROS.
  EXPECT_EQ(resolved({parse_override("backend=fake_baxter"), parse_override("fitting=ceres")}).id,
            test::shipped_config("paper/object_i.yaml", {"backend=fake_baxter", "fitting=ceres"}).id);
}

TEST_F(WithoutLibraries, AllOptionsAreListedAllTheSame) {
  std::vector<std::string> names;
  for (const FieldDescription& field :
       describe_fields([&](Fields& list) { host_.describe("backend", "baxter", list); })) {
    names.push_back(field.name);
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf({"motion", "tool", "scene_pose", "calibration", "force_sign",
                                              "inverse_kinematics", "dry_run", "bag"}));
}

}  // namespace
}  // namespace palpate::test
