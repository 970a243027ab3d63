// SPDX-License-Identifier: MIT
// A library is loaded when the config names the plugin that needs it, and only then.
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

namespace palpate {
namespace {

using testing::AnyOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

/// Every library that the dynamic loader initialised during a run of the paper's experiment with `overrides`.
std::set<std::string> loaded_libraries(const std::vector<std::string>& overrides) {
  const test::TemporaryFolder folder;
  std::vector<std::string> words{"run", (test::source_folder() / "configs/paper/object_i.yaml").string(), "--quiet"};
  words.insert(words.end(), overrides.begin(), overrides.end());
  const test::Ended ended = test::palpate(words, folder.path(), {"LD_DEBUG=files"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  std::set<std::string> out;
  std::istringstream lines(ended.err);
  for (std::string line; std::getline(lines, line);) {
    const auto mark = line.find("calling init: ");
    if (mark != std::string::npos) out.insert(line.substr(mark + 14));
  }
  return out;
}

/// Those of them that are plugins, as <kind>/<name>.so.
std::vector<std::string> plugins_among(const std::set<std::string>& libraries) {
  std::vector<std::string> out;
  for (const fs::path file : libraries) {
    const fs::path inner = file.lexically_relative(test::plugin_folder());
    if (*inner.begin() != "..") out.push_back(inner.string());
  }
  return out;
}

TEST(StartUp, LoadsThePluginsOfTheConfigAndNoLibraryOfAnother) {
  const std::set<std::string> fixed = loaded_libraries({});
  EXPECT_THAT(plugins_among(fixed), ElementsAre("acquisition/weighted.so", "backend/simulator.so", "fitting/fixed.so",
                                                "footprint/regression.so", "kernel/rbf.so", "shape/wave.so"));
  // What Ceres brings, whether it is linked into its plugin or not.
  const auto of_ceres = AnyOf(HasSubstr("libceres"), HasSubstr("libglog"), HasSubstr("lapack"), HasSubstr("blas"));
  EXPECT_THAT(fixed, Not(Contains(of_ceres)));

  const std::set<std::string> fitted = loaded_libraries({"fitting=ceres", "taps=4"});
  EXPECT_THAT(plugins_among(fitted), Contains("fitting/ceres.so"));
  EXPECT_THAT(fitted, Contains(of_ceres)) << "the test above would not see them either";
}

TEST(StartUp, LoadsTheLibrariesOfMeshesForAMeshAlone) {
  const auto of_meshes = AnyOf(HasSubstr("libassimp"), HasSubstr("libembree"), HasSubstr("libtbb"));
  const std::set<std::string> cone = loaded_libraries({"scene=cone"});
  EXPECT_THAT(plugins_among(cone), Contains("shape/cone.so"));
  EXPECT_THAT(plugins_among(cone), Not(Contains(AnyOf("shape/mesh.so", "shape/wave.so"))));
  EXPECT_THAT(cone, Not(Contains(of_meshes)));

  const std::string file = (test::source_folder() / "configs/scene/meshes/cup.stl").string();
  const std::set<std::string> cup = loaded_libraries({"scene=cup", "scene.objects.0.file=" + file});
  EXPECT_THAT(plugins_among(cup), Contains("shape/mesh.so"));
  EXPECT_THAT(cup, Contains(of_meshes)) << "the test above would not see them either";
}

}  // namespace
}  // namespace palpate
