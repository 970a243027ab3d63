// SPDX-License-Identifier: MIT
// What `palpate new` writes, built against the installed program: what the tutorial of plugins/README.md promises to
// plugin authors.
#include "support/parts.hpp"
#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The program installed into a folder of its own, and outside projects built against it.
class Consumer : public testing::Test {
 protected:
  void SetUp() override {
    const Ended ended = run_program(
        {PALPATE_CMAKE, "--install", program_file().parent_path().string(), "--prefix", prefix().string()}, here());
    ASSERT_EQ(ended.status, 0) << ended.out << ended.err;
  }

  void build_project(const fs::path& sources, const std::string& more_flags = "") {
    const std::string flags = std::string("-DCMAKE_CXX_FLAGS=" PALPATE_CXX_FLAGS) + more_flags;
    const Ended configured = run_program(
        {PALPATE_CMAKE, "-S", sources.string(), "-B", build().string(), "-G", PALPATE_GENERATOR,
         "-DCMAKE_PREFIX_PATH=" + prefix().string(), std::string("-DCMAKE_CXX_COMPILER=") + PALPATE_CXX_COMPILER,
         std::string("-DCMAKE_BUILD_TYPE=") + PALPATE_BUILD_TYPE, flags},
        here());
    ASSERT_EQ(configured.status, 0) << configured.out << configured.err;
    const Ended built = run_program({PALPATE_CMAKE, "--build", build().string()}, here());
    ASSERT_EQ(built.status, 0) << built.out << built.err;
  }

  /// Runs the installed program with the outside plugin on its search path.
  Ended installed(std::vector<std::string> words) const {
    words.insert(words.begin(), (prefix() / "bin" / "palpate").string());
    return run_program(words, here(), {search_path()});
  }

  const fs::path& here() const { return folder_.path(); }
  fs::path prefix() const { return here() / "prefix"; }
  fs::path build() const { return here() / "build"; }
  std::string search_path() const { return "PALPATE_PLUGIN_PATH=" + (build() / "lib" / "palpate").string(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(Consumer, InstallationIsComplete) {
  for (const char* file :
       {"bin/palpate", "lib/palpate/kernel/rbf.so", "lib/palpate/acquisition/weighted.so",
        "lib/palpate/fitting/fixed.so", "lib/palpate/backend/simulator.so", "lib/palpate/build.json",
        "lib/palpate/python/palpate_acquisition.py", "share/palpate/plugins/starters/python/starter.py",
        "share/palpate/configs/paper/object_i.yaml", "include/palpate/plugin.hpp",
        "lib/cmake/palpate/palpateConfig.cmake", "lib/cmake/palpate/palpateConfigVersion.cmake",
        "share/palpate/plugins/starters/kernel/starter.cpp", "share/man/man1/palpate.1",
        "share/man/man1/palpate-sweep.1", "share/bash-completion/completions/palpate",
        "share/zsh/site-functions/_palpate", "share/fish/vendor_completions.d/palpate.fish"}) {
    EXPECT_TRUE(fs::is_regular_file(prefix() / file)) << file;
  }
  // The program finds its own plugins and configs wherever it was put.
  const Ended ended =
      run_program({(prefix() / "bin" / "palpate").string(), "run",
                   (prefix() / "share/palpate/configs/paper/object_i.yaml").string(), "taps=4", "--quiet"},
                  here());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(fs::exists(only_run(here() / "runs") / "summary.json"));
}

TEST_F(Consumer, ProgramTellsVersionCommitAndBuildAndRunsItsOwnConfigsAnywhere) {
  const Ended told = installed({"--version"});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out,
              testing::MatchesRegex("palpate [0-9.]+\ncommit: ([0-9a-f]{40}|unknown)(, with changes that are in no "
                                    "commit)?\nbuild: [0-9a-f]{32}\ncompiler: .*\n"));
  const std::string build = told.out.substr(told.out.find("build: ") + 7, 32);

  ASSERT_FALSE(fs::exists(here() / "configs"));
  const Ended ended = installed({"run", "configs/paper/object_i.yaml", "taps=4", "--quiet"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(part_of(only_run(here() / "runs"), "manifest"),
              HasSubstr("\"build_without_plugins\": \"" + build + "\""));
  EXPECT_EQ(installed({"sweep", "configs/paper/object_i.yaml", "seed=1,2", "taps=4", "--quiet"}).status, 0);
  const Ended mesh = installed({"run", "configs/paper/object_i.yaml", "scene=cup", "taps=4", "name=cup", "--quiet"});
  EXPECT_EQ(mesh.status, 0) << mesh.err;
  const Ended missing = installed({"run", "configs/paper/object_x.yaml"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, testing::StartsWith("configs/paper/object_x.yaml: no such file"));
}

TEST_F(Consumer, EachKindHasAPluginToBeginWithThatBuildsRunsAndKeepsTheLaws) {
  const std::string refused = installed({"new", "kernel", "rbf"}).err;
  EXPECT_EQ(refused, "there is a plugin kernel/rbf already, choose another name\n");
  EXPECT_THAT(installed({"new", "kernel", "a/b"}).err, HasSubstr("'a/b' is not a valid name of a plugin, "));
  EXPECT_THAT(installed({"new", "kernels", "mine"}).err, HasSubstr("no plugin kind 'kernels', did you mean 'kernel'?"));
  for (const std::string& kind : PluginHost::kinds()) {
    const Ended made = installed({"new", kind, "my_" + kind});
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("-DCMAKE_PREFIX_PATH="));
    EXPECT_THAT(text_of(here() / ("my_" + kind) / ("my_" + kind + ".cpp")), testing::Not(HasSubstr("starter")));
  }
  EXPECT_THAT(installed({"new", "kernel", "my_kernel"}).err, HasSubstr("my_kernel: exists already, "));
  // Each is compiled and asked for all laws of its kind.
  for (const std::string& kind : brief() ? std::vector<std::string>{"kernel", "shape"} : PluginHost::kinds()) {
    const std::string name = "my_" + kind;
    build_project(here() / name);
    const Ended ended = installed({"run", (fs::path(name) / (name + ".yaml")).string(), "--json"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("\"status\": \"done\""));
    const Ended contract =
        run_program({PALPATE_CONTRACT_TESTS, "--gtest_filter=Every/*/" + name}, here(), {search_path()});
    EXPECT_EQ(contract.status, 0) << contract.out;
    EXPECT_THAT(contract.out, HasSubstr("[       OK ] Every/")) << name;
    if (kind == "kernel") {
      EXPECT_THAT(contract.out, HasSubstr("kernel/my_kernel is not differentiable: no fit may change it"));
      const std::string described = installed({"plugins", "kernel/my_kernel"}).out;
      EXPECT_THAT(described,
                  HasSubstr("kernel/my_kernel: custom kernel: correlation that decays slowly with distance"));
      EXPECT_THAT(described, testing::ContainsRegex("length_scale +length > 0 m +0.02 m +length scale, the distance"));
    }
    fs::remove_all(build());
  }
}

TEST_F(Consumer, PluginOfOtherAlignmentIsRefusedByItsName) {
#if !defined(__x86_64__) || defined(__AVX__)
  // The program already has that alignment, so nothing would differ and nothing could be refused.
  GTEST_SKIP() << "-mavx changes nothing in this build";
#endif
  installed({"new", "kernel", "mine"});
  build_project(here() / "mine", " -mavx");
  const Ended ended = installed({"run", "mine/mine.yaml"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  EXPECT_THAT(ended.err, testing::StartsWith("mine/mine.yaml:6:16: "));
  EXPECT_THAT(ended.err, HasSubstr("kernel/mine.so: comparing the build: built with EIGEN_MAX_ALIGN_BYTES=32, the "
                                   "program with EIGEN_MAX_ALIGN_BYTES=16, build it with the same compiler flags"));
}

/// The code block that installs palpate and builds a plugin against it.
std::string install_block(const fs::path& readme) {
  const std::string text = text_of(readme);
  const auto begin = text.find("```\ncmake --install ");
  if (begin == std::string::npos) throw std::runtime_error("no block installs palpate in " + readme.string());
  return text.substr(begin + 4, text.find("```", begin + 4) - begin - 4);
}

TEST(Tutorial, ItsCommandsBuildAndRunThePluginThatItShowsWithWhatTheProjectInstalls) {
  // A home with the clone in it, whose build is this one.
  const TemporaryFolder home;
  fs::create_directories(home.path() / "palpate" / "build");
  fs::create_directory_symlink(program_file().parent_path(), home.path() / "palpate" / "build" / "release");
  // Only what packages.txt names: make is not there where README's first command set the machine up.
  fs::create_directories(home.path() / "bin");
  const std::string refuse = "#!/bin/sh\necho 'no make here' >&2\nexit 127\n";
  for (const char* make : {"make", "gmake"})
    fs::permissions(home.write(std::string("bin/") + make, refuse), fs::perms::owner_all);
  const char* path = std::getenv("PATH");
  const Ended ended =
      run_program({"sh", "-euc", install_block(source_folder() / "plugins/README.md")}, home.path(),
                  {"HOME=" + home.path().string(), "CMAKE_GENERATOR",
                   "PATH=" + (home.path() / "bin").string() + ":" + (path != nullptr ? path : ""),
                   std::string("CXX=") + PALPATE_CXX_COMPILER, std::string("CXXFLAGS=") + PALPATE_CXX_FLAGS});
  EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("done: tap budget after"));
  const std::string tutorial = text_of(source_folder() / "plugins" / "README.md");
  const fs::path written = home.path() / "my_kernel";
  EXPECT_THAT(tutorial, HasSubstr("```cpp\n" + text_of(written / "my_kernel.cpp") + "```\n"));
  EXPECT_THAT(tutorial, HasSubstr("```cmake\n" + text_of(written / "CMakeLists.txt") + "```\n"));
  EXPECT_THAT(tutorial, HasSubstr("```yaml\n" + text_of(written / "my_kernel.yaml") + "```\n"));
}

}  // namespace
}  // namespace palpate::test
