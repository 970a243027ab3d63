// SPDX-License-Identifier: MIT
#include "host/plugin_host.hpp"

#include "config/describe.hpp"
#include "support/programs.hpp"
#include "support/testing.hpp"

#include <palpate/kernel.hpp>

#include <atomic>
#include <cstdlib>
#include <thread>

namespace palpate::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<FieldDescription> options_of(const PluginHost& host, const std::string& kind, const std::string& name) {
  return describe_fields([&](Fields& fields) { host.describe(kind, name, fields); });
}

std::string refusal_of(const std::string& kind, const std::string& name) {
  return error_of([&] { options_of(shared_host(), kind, name); });
}

/// Whether a file is mapped into this process.
bool mapped(const fs::path& file) { return text_of("/proc/self/maps").find(file.string()) != std::string::npos; }

/// A folder that holds a copy of kernel/rbf, so that its library is nobody else's.
fs::path copy_of_rbf(const TemporaryFolder& folder) {
  fs::create_directories(folder.path() / "kernel");
  fs::copy(plugin_folder() / "kernel" / "rbf.so", folder.path() / "kernel" / "rbf.so");
  return fs::canonical(folder.path()) / "kernel" / "rbf.so";
}

using PluginFolder = InFolder;

TEST_F(PluginFolder, OpensTheNamedFileAndNoOther) {
  const fs::path file = copy_of_rbf(folder_);
  fs::copy(plugin_folder() / "kernel" / "matern32.so", folder_.path() / "kernel" / "matern32.so");
  folder_.write("kernel/broken.so", "no library");
  const PluginHost host({folder_.path()});
  EXPECT_FALSE(mapped(file));
  EXPECT_EQ(options_of(host, "kernel", "rbf").size(), 2U);
  EXPECT_TRUE(mapped(file));
  EXPECT_FALSE(mapped(fs::canonical(folder_.path()) / "kernel" / "matern32.so"));
}

TEST_F(PluginFolder, TellsTheSameHashOfALibraryWithoutItsSymbolsAndAnotherOfOneWithAnotherByte) {
  const auto hash = [&] { return PluginHost({folder_.path()}).loaded({{"kernel", "rbf"}}).front().hash; };
  const fs::path file = copy_of_rbf(folder_);
  const std::string whole = hash();
  const auto size = fs::file_size(file);
  const Ended stripped =
      run_program({"strip", "--remove-section=.comment", "--remove-section=.note", "--strip-unneeded", file.string()},
                  folder_.path());
  ASSERT_EQ(stripped.status, 0) << stripped.err;
  EXPECT_LT(fs::file_size(file), size);
  EXPECT_EQ(hash(), whole);

  // A word that it says of itself, which is data and nothing else.
  std::string bytes = text_of(file);
  const auto at = bytes.find("squared exponential");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'S';
  fs::remove(file);  // it may still be mapped
  folder_.write("kernel/rbf.so", bytes);
  EXPECT_NE(hash(), whole);
}

TEST(PluginHost, TellsFileAndHashOfThePluginsAskedForAndOfNoOther) {
  const PluginHost host({plugin_folder()});
  options_of(host, "kernel", "matern32");
  const std::vector<LoadedPlugin> loaded = host.loaded({{"kernel", "rbf"}, {"acquisition", "grid"}});
  ASSERT_EQ(loaded.size(), 2U);
  EXPECT_EQ(loaded[0].kind, "acquisition");
  EXPECT_EQ(loaded[1].file, plugin_folder() / "kernel" / "rbf.so");
  EXPECT_EQ(loaded[1].hash.size(), 32U);
  EXPECT_NE(loaded[0].hash, loaded[1].hash);
}

TEST_F(PluginFolder, ObjectsKeepTheirLibraryAfterTheHostIsGone) {
  const fs::path file = copy_of_rbf(folder_);
  auto host = std::make_unique<PluginHost>(std::vector<fs::path>{folder_.path()});
  std::shared_ptr<Kernel> kernel = make<Kernel>(*host, "rbf", "{length_scale: 1 m}");
  host.reset();
  ASSERT_TRUE(mapped(file));
  Points points(2, 2);
  points << 0, 0, 1, 0;
  Eigen::MatrixXd out(2, 2);
  kernel->covariance(points, points, out);
  EXPECT_DOUBLE_EQ(out(0, 1), std::exp(-0.5));
  kernel.reset();
  EXPECT_FALSE(mapped(file));
}

TEST_F(PluginFolder, KeepsALibraryWhenItsObjectsAreGone) {
  const fs::path file = copy_of_rbf(folder_);
  const PluginHost host({folder_.path()});
  make<Kernel>(host, "rbf").reset();
  EXPECT_TRUE(mapped(file));
}

TEST(PluginHost, OffersTheNearestNameOrListsWhatThereIs) {
  EXPECT_EQ(refusal_of("kernel", "mattern52"), "no plugin kernel/mattern52, did you mean 'matern52'?");
  EXPECT_THAT(refusal_of("fitting", "zzzzzzzzzzzz"), HasSubstr("no plugin fitting/zzzzzzzzzzzz, known: ceres, fixed"));
}

TEST_F(PluginFolder, AFolderWithoutPluginsIsNamedRatherThanANeighbour) {
  const auto refusal_with = [&](const fs::path& other) {
    return error_of([&] { make<Kernel>(PluginHost({other, plugin_folder()}), "mattern52"); });
  };
  const std::string begin = "no plugin kernel/mattern52, the folder ";
  const fs::path missing = folder_.path() / "missing";
  EXPECT_EQ(refusal_with(missing), begin + missing.string() + " does not exist, see PALPATE_PLUGIN_PATH");
  folder_.write("kernel.so", "");
  EXPECT_EQ(refusal_with(folder_.path()),
            begin + folder_.path().string() + " contains no plugin KIND/NAME.so, see PALPATE_PLUGIN_PATH");
  const fs::path file = folder_.path() / "kernel.so";
  EXPECT_EQ(refusal_with(file), begin + file.string() + " is a file, see PALPATE_PLUGIN_PATH");
}

TEST(PluginHost, RefusesNamesWithAPath) {
  for (const char* name : {"../kernel/rbf", "/etc/passwd", "rbf.so", ".", "", "a b"}) {
    EXPECT_THAT(refusal_of("kernel", name), HasSubstr("is not a valid name of a plugin")) << name;
  }
}

TEST(PluginHost, SearchPathIsTheVariableWithoutEmptyPartsThenTheShippedFolder) {
  const auto search_path = [](const char* variable) {
    const EnvironmentVariable path("PALPATE_PLUGIN_PATH", variable);
    return PluginHost::search_path("/shipped");
  };
  EXPECT_THAT(search_path("/a/b:relative"), ElementsAre("/a/b", "relative", "/shipped"));
  EXPECT_THAT(search_path("::/a::/b:"), ElementsAre("/a", "/b", "/shipped"));
  EXPECT_THAT(search_path(""), ElementsAre("/shipped"));
}

TEST(PluginHost, MissingFoldersAreNoError) {
  const PluginHost host({"/nowhere", plugin_folder()});
  EXPECT_EQ(options_of(host, "kernel", "rbf").size(), 2U);
}

TEST(PluginHost, ListsShippedPluginsSortedAndSound) {
  std::vector<std::string> names;
  for (const PluginListing& row : shared_host().list("kernel", "")) {
    EXPECT_EQ(row.trouble, "");
    EXPECT_FALSE(row.summary.empty());
    names.push_back(row.name);
  }
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_THAT(names, testing::IsSupersetOf({"matern32", "matern52", "product", "rbf", "scale", "sum"}));
}

TEST_F(PluginFolder, ErrorsOutliveTheLibraryThatThrewThem) {
  auto host = std::make_unique<PluginHost>(std::vector<fs::path>{bad_plugin_folder("throws_own_exception")});
  std::exception_ptr kept;
  try {
    make<Kernel>(*host, "throws_own_exception");
  } catch (const Error&) {
    kept = std::current_exception();
  }
  host.reset();
  ASSERT_FALSE(mapped(bad_plugin_folder("throws_own_exception")));
  EXPECT_THAT(error_of([&] { std::rethrow_exception(kept); }), HasSubstr("an exception of its own"));
}

TEST(PluginHost, ServesSeveralThreads) {
  const PluginHost host({plugin_folder()});
  std::atomic<int> made{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (const char* name : {"rbf", "matern32", "matern52"}) {
        if (make<Kernel>(host, name)) ++made;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made, 24);
}

}  // namespace
}  // namespace palpate::test
