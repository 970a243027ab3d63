// SPDX-License-Identifier: MIT
// The backend for Baxter as a build without ROS has it.
#include "config/compose.hpp"
#include "config/describe.hpp"
#include "experiment/experiment.hpp"
#include "experiment/resolved.hpp"
#include "support/plugins.hpp"
#include "support/runs.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// The plugins of this build, but Baxter's as it is without ROS.
class WithoutRos : public ::testing::Test {
 protected:
  WithoutRos() {
    for (const char* kind : {"kernel", "acquisition", "footprint", "fitting", "shape"}) {
      fs::create_directory_symlink(test::plugin_folder() / kind, folder_.path() / kind);
    }
    fs::create_directory_symlink(test::bad_plugin_folder("without_ros") / "backend", folder_.path() / "backend");
  }
  PluginHost host() const { return PluginHost({folder_.path()}); }

 private:
  test::TemporaryFolder folder_;
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
std::string remedy() {
  return "this build has no ROS 1; 'sudo apt-get install --no-install-recommends " + packages("ros") +
         "' installs it, then build again, as ./palpate does by itself";
}

TEST_F(WithoutRos, ARunIsToldWhatToInstallAndNotFirstWhatItsConfigLacks) {
  ASSERT_NE(packages("ros"), "");
  const fs::path configs = test::source_folder() / "configs";
  const PluginHost plugins = host();
  for (const char* backend : {"backend=baxter", "backend=fake_baxter"}) {
    Composer composer(configs);
    const ResolvedConfig config =
        load_experiment(composer, plugins, configs / "paper" / "object_i.yaml", {parse_override(backend)});
    try {
      Experiment(config.options, plugins, nullptr);
      FAIL() << "a robot that this build cannot reach was accepted";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::EndsWith("backend/baxter: " + remedy()));
      EXPECT_EQ(error.kind(), Error::Kind::usage);
    }
  }
}

TEST_F(WithoutRos, WhatARobotRecordedElsewhereHasTheSameConfigAndId) {
  // So it can be replayed, compared and drawn at a desk without ROS.
  const fs::path configs = test::source_folder() / "configs";
  const PluginHost plugins = host();
  Composer composer(configs);
  const ResolvedConfig here =
      load_experiment(composer, plugins, configs / "paper" / "object_i.yaml", {parse_override("backend=fake_baxter")});
  EXPECT_EQ(here.id, test::shipped_config("paper/object_i.yaml", {"backend=fake_baxter"}).id);
}

TEST_F(WithoutRos, AllOptionsAreListedAllTheSame) {
  const PluginHost plugins = host();
  std::vector<std::string> names;
  for (const FieldDescription& field :
       describe_fields([&](Fields& list) { plugins.describe("backend", "baxter", list); })) {
    names.push_back(field.name);
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf({"motion", "tool", "place", "calibration", "force_sign",
                                              "inverse_kinematics", "dry_run", "bag"}));
}

}  // namespace
}  // namespace palpate
