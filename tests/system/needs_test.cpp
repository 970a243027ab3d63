// SPDX-License-Identifier: MIT
// What ./palpate asks the program to build for a command, with `--needs`, and what the program says where that was not
// built: it never compiles anything itself.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using Targets = std::set<std::string>;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsSubsetOf;
using testing::Not;

/// What every build of a run of the paper takes; a scene may take shapes beside.
const Targets kPaper{"palpate_kernel_rbf", "palpate_acquisition_weighted", "palpate_fitting_fixed",
                     "palpate_footprint_gp_regression", "palpate_backend_simulator"};

/// A build folder with nothing in it but the program and the list of plugins, as the first ./palpate finds it.
class FirstCommand : public Shell {
 protected:
  FirstCommand() {
    fs::create_directories(build() / "lib" / "palpate");
    fs::copy_file(program_file(), build() / "palpate");
    fs::copy_file(plugin_folder() / "plugins.txt", build() / "lib" / "palpate" / "plugins.txt");
    fs::create_directory_symlink(source_folder() / "configs", here() / "configs");
  }

  fs::path build() const { return here() / "build" / "release"; }
  Ended call(const Words& words) const { return run_program(Words{build() / "palpate"} + words, here()); }
  Targets needs(const Words& words) const {
    const Words said = call(Words{"--needs"} + words).out;
    return {said.begin(), said.end()};
  }
  /// Puts plugins of this build where they belong.
  void built(const std::string& kind, const std::string& name) const {
    fs::create_directories(build() / "lib" / "palpate" / kind);
    fs::copy_file(plugin_folder() / kind / (name + ".so"), build() / "lib" / "palpate" / kind / (name + ".so"));
  }
};

TEST_F(FirstCommand, ARunTakesThePluginsThatItsConfigNamesAndNothingElse) {
  const Targets found = needs({"run", paper()});
  EXPECT_THAT(kPaper, IsSubsetOf(found));
  for (const std::string& target : found) {
    EXPECT_TRUE(kPaper.count(target) != 0 || target.rfind("palpate_shape_", 0) == 0) << target;
  }
  EXPECT_THAT(found, Not(Contains("palpate_shape_mesh")));
  EXPECT_THAT(needs({"run", paper(), "kernel=matern52"}),
              AllOf(Contains("palpate_kernel_matern52"), Not(Contains("palpate_kernel_rbf"))));
}

TEST_F(FirstCommand, WhatAPluginNamesIsKnownOnceThatIsBuilt) {
  write("sum.yaml",
        "defaults:\n  - acquisition: weighted\n  - fitting: fixed\n  - backend: simulator\n  - scene: object_i\n"
        "kernel: {type: sum, kernels: [{type: rbf}, {type: matern32, length_scale: 2 cm}]}\n");
  const Targets first = needs({"run", "sum.yaml"});
  EXPECT_THAT(first, Contains("palpate_kernel_sum"));
  EXPECT_THAT(first, Contains("palpate_backend_simulator")) << "the sum's options, which nobody knows, are in no way";
  EXPECT_THAT(first, Not(Contains("palpate_kernel_matern32")));
  built("kernel", "sum");
  EXPECT_THAT(needs({"run", "sum.yaml"}), Contains("palpate_kernel_matern32"));
}

TEST_F(FirstCommand, SweepsTakeEverythingAndTheirTablesNoPlugin) {
  const Targets everything{"palpate_whole", "palpate_plugins"};
  EXPECT_EQ(needs({"sweep", paper(), "seed=1,2"}), everything);
  EXPECT_THAT(needs({"validate", config("sweep/fitting.yaml")}), testing::IsSupersetOf(everything));
  write("sweep/manifest.jsonl", "");
  EXPECT_EQ(needs({"resume", "sweep"}), everything);
  EXPECT_EQ(needs({"status", "sweep"}), Targets{"palpate_whole"});
  EXPECT_EQ(needs("list"), Targets{"palpate_whole"});
  EXPECT_EQ(needs({"pareto", "sweep", "--cost", "taps", "--error", "rmse_m"}), Targets{"palpate_whole"});
  EXPECT_EQ(needs({"compare", "sweep", "--by", "seed", "--metric", "rmse_m", "--at", "3"}), everything);
}

TEST_F(FirstCommand, LookingAtARunTakesItsPluginsAndListingThemThoseThatAreListed) {
  write("run/config.yaml", text_of(paper()));
  EXPECT_EQ(needs({"status", "run"}), Targets{});
  write("one/config.yaml", test::palpate({"run", paper(), "--print-config"}, build()).out);
  EXPECT_THAT(kPaper, IsSubsetOf(needs({"replay", "one"})));
  EXPECT_THAT(needs({"replay", "one"}), Not(Contains("palpate_whole")));
  EXPECT_THAT(needs({"explain", "one", "3"}), Contains("palpate_whole"));
  EXPECT_THAT(needs({"watch", "one"}), Contains("palpate_whole"));
  EXPECT_THAT(kPaper, IsSubsetOf(needs({"watch", "one"})));
  EXPECT_THAT(needs({"run", paper(), "--watch"}), Contains("palpate_whole"));
  EXPECT_EQ(needs({"plugins", "kernel/rbf"}), Targets{"palpate_kernel_rbf"});
  EXPECT_THAT(needs({"plugins", "kernel"}), Contains("palpate_kernel_matern52"));
  EXPECT_THAT(needs({"plugins", "kernel"}), Not(Contains("palpate_backend_simulator")));
  EXPECT_EQ(needs({"schema"}), Targets{"palpate_plugins"});
}

TEST_F(FirstCommand, CalledByItselfTheProgramSaysWhatIsNotBuilt) {
  const Ended run = call({"run", paper()});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("plugin kernel/rbf is not built, build it with ./palpate, or with 'cmake --build "));
  EXPECT_EQ(lines(run.err), 1);
  EXPECT_THAT(call({"run", paper(), "kernel.type=matern25"}).err, HasSubstr("did you mean 'matern52'?"));
  const Ended sweep = call({"sweep", paper(), "seed=1,2"});
  EXPECT_EQ(sweep.status, 2);
  EXPECT_THAT(sweep.err, HasSubstr("palpate-whole: has this command but is not built, build it with ./palpate, or"));
  EXPECT_EQ(lines(sweep.err), 1);
}

TEST(CoreHash, IsOverEveryLibraryOfTheProjectThatIsLinkedWithCore) {
  const std::string rules = text_of(program_file().parent_path() / "build.ninja");
  const auto line_with = [&](const std::string& mark) {
    const auto at = rules.find(mark);
    return at == std::string::npos ? "" : rules.substr(at, rules.find('\n', at + 1) - at);
  };
  const std::string linked = line_with("\nbuild palpate: ");
  const std::string hashed = line_with("-DFILES=");
  const std::regex library("/lib(palpate_[a-z]+)\\.a");
  int found = 0;
  for (std::sregex_iterator at(linked.begin(), linked.end(), library), end; at != end; ++at) {
    if ((*at)[1] == "palpate_commands") continue;  // what they say makes no other build
    EXPECT_THAT(hashed, HasSubstr("/" + (*at)[1].str() + ".dir/"));
    ++found;
  }
  EXPECT_GE(found, 6);
}

using Builds = Shell;

TEST_F(Builds, AJobOfASweepIsOfTheBuildOfARun) {
  const auto build = [](const fs::path& run) {
    const std::string manifest = part_of(run, "manifest");
    return manifest.substr(manifest.find("\"build\": \""), 30);
  };
  EXPECT_EQ(build(ran("taps=3")), build(jobs_of(swept("taps=3 seed=1,2")).front()));
}

}  // namespace
}  // namespace palpate::test
