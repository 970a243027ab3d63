// SPDX-License-Identifier: MIT
// A library is loaded when the config names the plugin that needs it, and only then.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace palpate {
namespace {

using testing::AnyOf;
using testing::Contains;

class StartUp : public Shell {
 protected:
  StartUp() { environment_ = {"LD_DEBUG=files"}; }

  /// Every library that the dynamic loader initialised during a run of the paper's experiment with `overrides`.
  std::set<std::string> loaded_libraries(const Words& overrides) const {
    const Ended ended = run(Words{"--quiet"} + overrides);
    EXPECT_EQ(ended.status, 0) << ended.err;
    std::set<std::string> out;
    for (const std::string& line : lines_of(ended.err)) {
      const auto mark = line.find("calling init: ");
      if (mark != std::string::npos) out.insert(line.substr(mark + 14));
    }
    return out;
  }
};

/// Those of them that are plugins, as <kind>/<name>.so.
std::vector<std::string> plugins_among(const std::set<std::string>& libraries) {
  std::vector<std::string> out;
  for (const fs::path file : libraries) {
    const fs::path inner = file.lexically_relative(test::plugin_folder());
    if (*inner.begin() != "..") out.push_back(inner.string());
  }
  return out;
}

TEST_F(StartUp, LoadsThePluginsOfTheConfigAndNoLibraryOfAnother) {
  const std::set<std::string> fixed = loaded_libraries({});
  EXPECT_THAT(plugins_among(fixed), ElementsAre("acquisition/weighted.so", "backend/simulator.so", "fitting/fixed.so",
                                                "footprint/gp_regression.so", "kernel/rbf.so", "shape/wave.so"));
  // What Ceres brings, whether it is linked into its plugin or not.
  const auto of_ceres = AnyOf(HasSubstr("libceres"), HasSubstr("libglog"), HasSubstr("lapack"), HasSubstr("blas"));
  EXPECT_THAT(fixed, Not(Contains(of_ceres)));

  const std::set<std::string> fitted = loaded_libraries("fitting=ceres taps=4");
  EXPECT_THAT(plugins_among(fitted), Contains("fitting/ceres.so"));
  EXPECT_THAT(fitted, Contains(of_ceres)) << "the test above would not see them either";
}

TEST_F(StartUp, LoadsTheLibrariesOfMeshesForAMeshAlone) {
  const auto of_meshes = AnyOf(HasSubstr("libassimp"), HasSubstr("libembree"), HasSubstr("libtbb"));
  const std::set<std::string> cone = loaded_libraries("scene=cone");
  EXPECT_THAT(plugins_among(cone), Contains("shape/cone.so"));
  EXPECT_THAT(plugins_among(cone), Not(Contains(AnyOf("shape/mesh.so", "shape/wave.so"))));
  EXPECT_THAT(cone, Not(Contains(of_meshes)));

  const std::set<std::string> cup =
      loaded_libraries({"scene=cup", "scene.objects.0.file=" + config("scene/meshes/cup.stl")});
  EXPECT_THAT(plugins_among(cup), Contains("shape/mesh.so"));
  EXPECT_THAT(cup, Contains(of_meshes)) << "the test above would not see them either";
}

}  // namespace
}  // namespace palpate
