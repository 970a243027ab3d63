// SPDX-License-Identifier: MIT
// Broken plugin libraries: each is one line on stderr with file, step and reason, spoils nothing else, and never ends
// the program by a signal. The libraries come from tests/bad_plugins or are made here.
#include "system/shell.hpp"

#include <palpate/plugin.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>

#include <unistd.h>

namespace palpate {
namespace {

/// A config that is sound but for its kernel or its acquisition.
std::string config_with(const std::string& kind, const std::string& name) {
  const auto type = [&](const std::string& own, const std::string& sound) { return own == kind ? name : sound; };
  return "kernel: {type: " + type("kernel", "rbf") + "}\nacquisition: {type: " + type("acquisition", "weighted") +
         "}\nfitting: {type: fixed}\nbackend: {type: simulator}\ntaps: 5\nscene: {area: {width: 23 cm, depth: 23 "
         "cm}}\n";
}

/// The place of the type in config_with("kernel", ...).
const char* const kPlace = "exp.yaml:1:16: ";

class BadPlugin : public Shell {
 protected:
  void search(const fs::path& folder) { environment_ = {"PALPATE_PLUGIN_PATH=" + folder.string()}; }

  /// `palpate plugins` tells of broken libraries, a line each, and lists the others.
  std::string listed_as_broken(int libraries = 1) const {
    const Ended ended = palpate("plugins");
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_EQ(lines(ended.err), libraries) << ended.err;
    EXPECT_THAT(ended.out, AllOf(HasSubstr("matern52"), HasSubstr("simulator")));
    return ended.err;
  }

  void expect_listed_as_broken(const std::string& line_start, const std::string& line_part) const {
    EXPECT_THAT(listed_as_broken(), AllOf(StartsWith(line_start), HasSubstr(line_part)));
    const Ended json = palpate("plugins --json");
    EXPECT_EQ(json.status, 1);
    EXPECT_THAT(json.out, HasSubstr(line_start));
  }

  /// A run whose config names the plugin says so in one line, place first, and leaves nothing behind.
  void expect_refused(const std::string& name, const std::string& place, const std::string& part) const {
    write("exp.yaml", config_with("kernel", name));
    EXPECT_THAT(refused("run exp.yaml"), AllOf(StartsWith(place), HasSubstr(part)));
    EXPECT_TRUE(left_nothing());
  }

  void expect_broken(const fs::path& folder, const std::string& name, const std::string& part) {
    search(folder);
    const std::string file = (folder / "kernel" / (name + ".so")).string();
    expect_listed_as_broken(file + ": ", part);
    expect_refused(name, kPlace + file + ": ", part);
  }

  /// Where a library of this build or another file is put as a kernel of its own name.
  fs::path kernel(const std::string& name) const {
    fs::create_directories(here() / "kernel");
    return here() / "kernel" / (name + ".so");
  }
  static std::string rbf() { return text_of(test::plugin_folder() / "kernel" / "rbf.so"); }
};

/// A library of tests/bad_plugins, and what is said of it.
struct Broken {
  const char* name;
  std::string part;
};

void PrintTo(const Broken& one, std::ostream* out) { *out << one.name; }

class BrokenPlugin : public BadPlugin, public testing::WithParamInterface<Broken> {};

TEST_P(BrokenPlugin, IsNamedWithStepAndReason) {
  expect_broken(test::bad_plugin_folder(GetParam().name), GetParam().name, GetParam().part);
}

INSTANTIATE_TEST_SUITE_P(
    Of, BrokenPlugin,
    testing::Values(Broken{"no_symbol",
                           "finding the symbol: no symbol 'palpate_plugin', end the source with PALPATE_PLUGIN(...)"},
                    Broken{"wrong_magic", "reading the manifest: the symbol 'palpate_plugin' is not a plugin manifest"},
                    Broken{"other_abi", "comparing the ABI: built for ABI " + std::to_string(kPluginAbi + 41) +
                                            ", the program has " + std::to_string(kPluginAbi)},
                    Broken{"other_alignment",
                           "comparing the build: built with EIGEN_MAX_ALIGN_BYTES=128, the program with "
                           "EIGEN_MAX_ALIGN_BYTES=" PALPATE_TEXT(EIGEN_MAX_ALIGN_BYTES)},
                    Broken{"undefined_symbol", "defined_nowhere"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(BadPlugin, UnderAnotherNameOrInTheFolderOfAnotherKindSaysWhatItIs) {
  fs::copy(test::plugin_folder() / "kernel" / "rbf.so", kernel("mine"));
  expect_broken(here(), "mine", "comparing the name: the library contains the plugin kernel/rbf");
  fs::remove(kernel("mine"));
  fs::copy(test::plugin_folder() / "acquisition" / "weighted.so", kernel("weighted"));
  expect_broken(here(), "weighted", "comparing the name: the library contains the plugin acquisition/weighted");
}

TEST_F(BadPlugin, ThatIsATextFileIsNoLibrary) {
  write(kernel("note"), "no library, but long enough to hold the header of one: " + std::string(200, 'x'));
  expect_broken(here(), "note", "reading the header: not a shared library");
}

TEST_F(BadPlugin, ThatIsAFolderIsNoLibrary) {
  fs::create_directories(kernel("folder"));
  expect_broken(here(), "folder", "opening: not a regular file");
}

TEST_F(BadPlugin, ThatIsADanglingLinkSaysSo) {
  fs::create_symlink("nowhere.so", kernel("link"));
  expect_broken(here(), "link", "opening: a link to a missing file");
}

TEST_F(BadPlugin, ThatCannotBeReadSaysSo) {
  const fs::path file = write(kernel("secret"), "x");
  fs::permissions(file, fs::perms::none);
  // The superuser reads it all the same, and finds no library in it.
  const bool readable = ::access(file.c_str(), R_OK) == 0;
  expect_broken(here(), "secret", readable ? "not a shared library" : "opening: Permission denied");
}

TEST_F(BadPlugin, CutShortNeverCrashesTheProgram) {
  // All cuts in one folder: a single crash would end the one process that lists them.
  const std::string whole = rbf();
  ASSERT_GT(whole.size(), 10000U);
  std::set<std::size_t> lengths{
      0, 1, 3, 4, 15, 16, 63, 64, 65, 1000, 4095, 4096, 4097, whole.size() - 64, whole.size() - 1};
  for (std::size_t i = 1; i < 100; ++i) lengths.insert(whole.size() * i / 100);
  for (const std::size_t length : lengths) write(kernel("cut" + std::to_string(length)), whole.substr(0, length));
  search(here());
  const std::string said = listed_as_broken(static_cast<int>(lengths.size()));
  for (const std::size_t length : lengths) {
    EXPECT_THAT(said, HasSubstr("kernel/cut" + std::to_string(length) +
                                ".so: reading the header: not a complete shared library, build or copy it again\n"));
  }
  expect_refused("cut4096", kPlace, "not a complete shared library");
}

TEST_F(BadPlugin, WithAFlippedBitIsListedOrListedPast) {
  const std::string whole = rbf();
  constexpr std::size_t kFlips = 120;
  for (std::size_t i = 0; i < kFlips; ++i) {
    std::string bytes = whole;
    bytes[i * whole.size() / kFlips] ^= static_cast<char>(1 << i % 8);
    write(kernel("flip" + std::to_string(i)), bytes);
  }
  search(here());
  const std::string said = listed_as_broken(kFlips);  // each is another plugin than its file's name says, or worse
  for (std::size_t i = 0; i < kFlips; ++i) EXPECT_THAT(said, HasSubstr("/flip" + std::to_string(i) + ".so: "));
}

TEST_F(BadPlugin, ThatTakesItsProcessDownIsListedWithHow) {
  for (const auto& [name, how] : std::vector<std::pair<std::string, std::string>>{
           {"crashes_when_loaded", "crashed, signal 11 (Segmentation fault)"},
           {"hangs_when_loaded", "did not finish within 5 s"},
           {"ends_when_loaded", "ended the program with status 0"}}) {
    const fs::path folder = test::bad_plugin_folder(name);
    search(folder);
    expect_listed_as_broken((folder / "kernel" / (name + ".so")).string() + ": loading: " + how,
                            ", build or copy it again\n");
  }
}

TEST_F(BadPlugin, WhoseBytesBehindTheHeaderAreZeroIsRefused) {
  // What a copy leaves that was cut by a crash after the file had got its length.
  std::string bytes = rbf();
  std::fill(bytes.begin() + 64, bytes.end(), '\0');
  write(kernel("zeros"), bytes);
  search(here());
  listed_as_broken();
}

TEST_F(BadPlugin, InTwoFoldersIsRefusedOnceWithBothNames) {
  fs::copy(test::plugin_folder() / "kernel" / "rbf.so", kernel("rbf"));
  search(here());
  EXPECT_THAT(listed_as_broken(),
              AllOf(StartsWith("plugin kernel/rbf exists twice: " + kernel("rbf").string() + " and "),
                    HasSubstr("lib/palpate/kernel/rbf.so, remove one")));
  expect_refused("rbf", kPlace, "plugin kernel/rbf exists twice: ");
}

TEST_F(BadPlugin, PathThatNamesTheShippedFolderAgainIsNoDuplicate) {
  search(test::plugin_folder().string() + "/../palpate/");
  const Ended ended = palpate("plugins");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
}

TEST_F(BadPlugin, ThatCannotListItsOptionsIsBroken) {
  environment_ = {test::with_plugin("throws_in_list")};
  const std::string said = "kernel/throws_in_list cannot list its options: ";
  expect_listed_as_broken(said, "an exception of its own");
  expect_refused("throws_in_list", kPlace, said + "an exception of its own");
}

TEST_F(BadPlugin, NamedOnTheCommandLineIsRefusedThere) {
  environment_ = {test::with_plugin("no_symbol")};
  write("exp.yaml", config_with("kernel", "rbf"));
  EXPECT_THAT(refused("run exp.yaml kernel.type=no_symbol"),
              AllOf(StartsWith("command line: "), HasSubstr("no_symbol.so: finding the symbol")));
}

/// Constructors that throw: the library is sound, so it is listed; the run is refused before it leaves a trace.
class ThrowingPlugin : public BadPlugin, public testing::WithParamInterface<Broken> {};

TEST_P(ThrowingPlugin, IsListedAndWhatItThrewIsToldInOneLine) {
  environment_ = {test::with_plugin(GetParam().name)};
  const Ended list = palpate("plugins");
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr(GetParam().name));
  expect_refused(GetParam().name, GetParam().part, "\n");
}

INSTANTIATE_TEST_SUITE_P(
    Of, ThrowingPlugin,
    testing::Values(
        Broken{"throws_error", "exp.yaml:1:16: kernel/throws_error: this kernel refuses its options, choose another\n"},
        Broken{"throws_error_with_place", "table.csv:7: this kernel refuses its table\n"},
        Broken{"throws_runtime_error", "exp.yaml:1:16: kernel/throws_runtime_error cannot be created: two lines\n"},
        Broken{"throws_own_exception",
               "exp.yaml:1:16: kernel/throws_own_exception cannot be created: an exception of its own\n"},
        Broken{"throws_number",
               "exp.yaml:1:16: kernel/throws_number cannot be created: it threw an object that is not a "
               "std::exception\n"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(BadPlugin, ThrowingInTheMiddleOfARunFailsTheRunInGoodOrder) {
  for (const auto& [name, reason] : std::vector<std::pair<std::string, std::string>>{
           {"throws_in_score", "acquisition/throws_in_score: no score today"},
           {"reads_untold",
            "acquisition/reads_untold: reads label_mean, which its reads() does not list, add it there"},
           {"throws_number_in_score",
            "acquisition/throws_number_in_score: threw an object that is not a std::exception"}}) {
    environment_ = {test::with_plugin(name)};
    write("exp.yaml", config_with("acquisition", name));
    const Ended ended = palpate({"run", "exp.yaml", "--runs", name});
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_EQ(ended.err, reason + "\n");
    const Ended status = status_of(directory(name));
    EXPECT_THAT(status.out + status.err, AllOf(HasSubstr("failed"), HasSubstr(reason)));
  }
}

TEST_F(BadPlugin, ThrowingWhenToldOfATapLosesNoTap) {
  environment_ = {test::with_plugin("throws_when_told")};
  const Ended ended =
      palpate({"run", test::config("default.yaml"), "belief.footprint=throws_when_told", "--runs", "runs"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "footprint/throws_when_told: no touch today\n");
  const std::string taps = part_of(directory("runs"), "tap");
  EXPECT_EQ(std::count(taps.begin(), taps.end(), '\n'), 3);
  // Carried on, it fails as it takes the last tap in again, which is no reason to be anything but failed.
  const Ended retried = palpate({"resume", directory("runs"), "--retry-failed"});
  EXPECT_EQ(retried.status, 1);
  EXPECT_EQ(retried.err, ended.err);
  EXPECT_EQ(part_of(directory("runs"), "tap"), taps);
  // Nor is a build that cannot make the run.
  environment_.clear();
  EXPECT_NE(palpate({"resume", directory("runs"), "--retry-failed", "--force"}).status, 0);
  environment_ = {test::with_plugin("throws_when_told")};
  EXPECT_THAT(status_of(directory("runs")).out,
              HasSubstr("failed after 3 of 30 taps: footprint/throws_when_told: no touch today"));
}

}  // namespace
}  // namespace palpate
