// SPDX-License-Identifier: MIT
// Broken plugin libraries: each is one line on stderr with file, step and reason, spoils nothing else, and never ends
// the program by a signal. The libraries come from tests/bad_plugins or are made here.
#include "support/support.hpp"

#include <palpate/plugin.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

/// A config that is sound but for its kernel or its acquisition.
std::string config_with(const std::string& kind, const std::string& name) {
  const auto type = [&](const std::string& own, const std::string& sound) { return own == kind ? name : sound; };
  return "kernel: {type: " + type("kernel", "rbf") + "}\nacquisition: {type: " + type("acquisition", "weighted") +
         "}\nfitting: {type: fixed}\nbackend: {type: simulator}\ntaps: 5\nscene: {area: {width: 23 cm, depth: 23 "
         "cm}}\n";
}

std::vector<std::string> search(const fs::path& folder) { return {"PALPATE_PLUGIN_PATH=" + folder.string()}; }

long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

/// `palpate plugins` with `folder` on the search path must tell of one broken library, and list the others.
void expect_listed_as_broken(const fs::path& folder, const std::string& line_start, const std::string& line_part) {
  const TemporaryFolder here;
  const Ended ended = palpate({"plugins"}, here.path(), search(folder));
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_THAT(ended.err, StartsWith(line_start));
  EXPECT_THAT(ended.err, HasSubstr(line_part));
  EXPECT_THAT(ended.out, HasSubstr("matern52"));
  EXPECT_THAT(ended.out, HasSubstr("simulator"));

  const Ended json = palpate({"plugins", "--json"}, here.path(), search(folder));
  EXPECT_EQ(json.status, 1);
  EXPECT_THAT(json.out, HasSubstr(line_start));
}

/// A run whose config names the plugin must say so in one line, place first, and leave nothing behind.
void expect_refused(const fs::path& folder, const std::string& name, const std::string& place,
                    const std::string& part) {
  const TemporaryFolder here;
  here.write("exp.yaml", config_with("kernel", name));
  const Ended ended = palpate({"run", "exp.yaml"}, here.path(), search(folder));
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_THAT(ended.err, StartsWith(place));
  EXPECT_THAT(ended.err, HasSubstr(part));
  EXPECT_EQ(ended.out, "");
  EXPECT_FALSE(fs::exists(here.path() / "runs"));
}

/// The place of the type in config_with("kernel", ...).
const char* const kPlace = "exp.yaml:1:16: ";

void expect_broken(const fs::path& folder, const std::string& name, const std::string& part) {
  const std::string file = (folder / "kernel" / (name + ".so")).string();
  expect_listed_as_broken(folder, file + ": ", part);
  expect_refused(folder, name, kPlace + file + ": ", part);
}

void expect_broken(const std::string& name, const std::string& part) {
  expect_broken(bad_plugin_folder(name), name, part);
}

TEST(BadPlugin, WithoutTheSymbolIsNamed) {
  expect_broken("no_symbol", "finding the symbol: no symbol 'palpate_plugin', end the source with PALPATE_PLUGIN(...)");
}

TEST(BadPlugin, WithAnotherMagicIsNamed) {
  expect_broken("wrong_magic", "reading the manifest: the symbol 'palpate_plugin' is not a plugin manifest");
}

TEST(BadPlugin, OfAnotherAbiIsRefusedBeforeAnythingElseIsRead) {
  expect_broken("other_abi", "comparing the ABI: built for ABI " + std::to_string(kPluginAbi + 41) +
                                 ", the program has " + std::to_string(kPluginAbi));
}

TEST(BadPlugin, OfAnotherAlignmentNamesWhatDiffers) {
  expect_broken("other_alignment",
                "comparing the build: built with EIGEN_MAX_ALIGN_BYTES=128, the program with "
                "EIGEN_MAX_ALIGN_BYTES=" PALPATE_TEXT(EIGEN_MAX_ALIGN_BYTES));
}

TEST(BadPlugin, WithAnUndefinedSymbolNamesIt) { expect_broken("undefined_symbol", "defined_nowhere"); }

TEST(BadPlugin, UnderAnotherNameSaysWhatItIs) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "kernel");
  fs::copy(plugin_folder() / "kernel" / "rbf.so", folder.path() / "kernel" / "mine.so");
  expect_broken(folder.path(), "mine", "comparing the name: the library says it is kernel/rbf");
}

TEST(BadPlugin, InTheFolderOfAnotherKindSaysWhatItIs) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "kernel");
  fs::copy(plugin_folder() / "acquisition" / "weighted.so", folder.path() / "kernel" / "weighted.so");
  expect_broken(folder.path(), "weighted", "comparing the name: the library says it is acquisition/weighted");
}

TEST(BadPlugin, ThatIsATextFileIsNoLibrary) {
  const TemporaryFolder folder;
  folder.write("kernel/note.so", "no library, but long enough to hold the header of one: " + std::string(200, 'x'));
  expect_broken(folder.path(), "note", "reading the header: not a shared library");
}

TEST(BadPlugin, ThatIsAFolderIsNoLibrary) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "kernel" / "folder.so");
  expect_broken(folder.path(), "folder", "opening: not a regular file");
}

TEST(BadPlugin, ThatIsADanglingLinkSaysSo) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "kernel");
  fs::create_symlink("nowhere.so", folder.path() / "kernel" / "link.so");
  expect_broken(folder.path(), "link", "opening: a link to a file that is not there");
}

TEST(BadPlugin, ThatCannotBeReadSaysSo) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("kernel/secret.so", "x");
  fs::permissions(file, fs::perms::none);
  // The superuser reads it all the same, and finds no library in it.
  const bool readable = ::access(file.c_str(), R_OK) == 0;
  expect_broken(folder.path(), "secret", readable ? "not a shared library" : "opening: Permission denied");
}

TEST(BadPlugin, CutShortNeverCrashesTheProgram) {
  // All cuts in one folder: a single crash would end the one process that lists them.
  const TemporaryFolder folder;
  const std::string whole = text_of(plugin_folder() / "kernel" / "rbf.so");
  ASSERT_GT(whole.size(), 10000U);
  std::vector<std::size_t> lengths{
      0, 1, 3, 4, 15, 16, 63, 64, 65, 1000, 4095, 4096, 4097, whole.size() - 64, whole.size() - 1};
  for (std::size_t i = 1; i < 100; ++i) lengths.push_back(whole.size() * i / 100);
  std::sort(lengths.begin(), lengths.end());
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  for (const std::size_t length : lengths) {
    folder.write("kernel/cut" + std::to_string(length) + ".so", whole.substr(0, length));
  }
  const Ended ended = palpate({"plugins"}, folder.path(), search(folder.path()));
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(lines(ended.err), static_cast<long>(lengths.size())) << ended.err;
  for (const std::size_t length : lengths) {
    EXPECT_THAT(ended.err,
                HasSubstr("kernel/cut" + std::to_string(length) +
                          ".so: reading the header: not a complete shared library, build or copy it again\n"));
  }
  EXPECT_THAT(ended.out, HasSubstr("matern52"));
  expect_refused(folder.path(), "cut4096", kPlace, "not a complete shared library");
}

TEST(BadPlugin, WithAFlippedBitIsListedOrListedPast) {
  const TemporaryFolder folder;
  const std::string whole = text_of(plugin_folder() / "kernel" / "rbf.so");
  constexpr std::size_t kFlips = 120;
  for (std::size_t i = 0; i < kFlips; ++i) {
    std::string bytes = whole;
    bytes[i * whole.size() / kFlips] ^= static_cast<char>(1 << i % 8);
    folder.write("kernel/flip" + std::to_string(i) + ".so", bytes);
  }
  const Ended ended = palpate({"plugins"}, folder.path(), search(folder.path()));
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_EQ(lines(ended.err), static_cast<long>(kFlips))
      << "each is another plugin than its file's name says, or worse";
  for (std::size_t i = 0; i < kFlips; ++i) EXPECT_THAT(ended.err, HasSubstr("/flip" + std::to_string(i) + ".so: "));
  EXPECT_THAT(ended.out, HasSubstr("matern52"));
}

TEST(BadPlugin, ThatTakesItsProcessDownIsListedWithHow) {
  for (const auto& [name, how] : std::vector<std::pair<std::string, std::string>>{
           {"crashes_when_loaded", "crashed, signal 11 (Segmentation fault)"},
           {"hangs_when_loaded", "came to no end within 5 s"},
           {"ends_when_loaded", "ended the program with status 0"}}) {
    const fs::path file = bad_plugin_folder(name) / "kernel" / (name + ".so");
    expect_listed_as_broken(bad_plugin_folder(name), file.string() + ": loading: " + how, ", build or copy it again\n");
  }
}

TEST(BadPlugin, WhoseBytesBehindTheHeaderAreZeroIsRefused) {
  // What a copy leaves that was cut by a crash after the file had got its length.
  const TemporaryFolder folder;
  std::string bytes = text_of(plugin_folder() / "kernel" / "rbf.so");
  std::fill(bytes.begin() + 64, bytes.end(), '\0');
  folder.write("kernel/zeros.so", bytes);
  const Ended ended = palpate({"plugins"}, folder.path(), search(folder.path()));
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
}

TEST(BadPlugin, InTwoFoldersIsRefusedOnceWithBothNames) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "kernel");
  const fs::path twin = folder.path() / "kernel" / "rbf.so";
  fs::copy(plugin_folder() / "kernel" / "rbf.so", twin);
  const Ended ended = palpate({"plugins"}, folder.path(), search(folder.path()));
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_THAT(ended.err, StartsWith("plugin kernel/rbf is there twice: " + twin.string() + " and "));
  EXPECT_THAT(ended.err, HasSubstr("lib/palpate/kernel/rbf.so, remove one"));
  EXPECT_THAT(ended.out, HasSubstr("matern52"));
  expect_refused(folder.path(), "rbf", kPlace, "plugin kernel/rbf is there twice: ");
}

TEST(BadPlugin, PathThatNamesTheShippedFolderAgainIsNoDuplicate) {
  const TemporaryFolder here;
  const Ended ended = palpate({"plugins"}, here.path(), search(plugin_folder().string() + "/../palpate/"));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
}

TEST(BadPlugin, ThatCannotListItsOptionsIsBroken) {
  const fs::path folder = bad_plugin_folder("throws_in_list");
  expect_listed_as_broken(folder, "kernel/throws_in_list cannot list its options: ", "an exception of its own");
  expect_refused(folder, "throws_in_list", kPlace,
                 "kernel/throws_in_list cannot list its options: an exception of its own");
}

TEST(BadPlugin, NamedOnTheCommandLineIsRefusedThere) {
  const TemporaryFolder here;
  here.write("exp.yaml", config_with("kernel", "rbf"));
  const Ended ended =
      palpate({"run", "exp.yaml", "kernel.type=no_symbol"}, here.path(), search(bad_plugin_folder("no_symbol")));
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, StartsWith("command line: "));
  EXPECT_THAT(ended.err, HasSubstr("no_symbol.so: finding the symbol"));
}

/// Constructors that throw: the library is sound, so it is listed; the run is refused before it leaves a trace.
void expect_refused_by_constructor(const std::string& name, const std::string& line) {
  const fs::path folder = bad_plugin_folder(name);
  const TemporaryFolder here;
  const Ended list = palpate({"plugins"}, here.path(), search(folder));
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr(name));
  expect_refused(folder, name, line, "\n");
}

TEST(ThrowingPlugin, ErrorIsCaughtByTypeAndGetsThePlaceOfTheConfig) {
  expect_refused_by_constructor(
      "throws_error", "exp.yaml:1:16: kernel/throws_error: this kernel refuses its options, choose another\n");
}

TEST(ThrowingPlugin, ErrorWithAPlaceOfItsOwnKeepsIt) {
  expect_refused_by_constructor("throws_error_with_place", "table.csv:7: this kernel refuses its table\n");
}

TEST(ThrowingPlugin, StandardExceptionIsToldInOneLine) {
  expect_refused_by_constructor("throws_runtime_error",
                                "exp.yaml:1:16: kernel/throws_runtime_error cannot be created: two lines\n");
}

TEST(ThrowingPlugin, ExceptionOfThePluginIsTold) {
  expect_refused_by_constructor(
      "throws_own_exception",
      "exp.yaml:1:16: kernel/throws_own_exception cannot be created: an exception of its own\n");
}

TEST(ThrowingPlugin, WhatIsNoExceptionIsToldToo) {
  expect_refused_by_constructor(
      "throws_number",
      "exp.yaml:1:16: kernel/throws_number cannot be created: it threw something that is no exception\n");
}

TEST(ThrowingPlugin, ThrowingInTheMiddleOfARunFailsTheRunInGoodOrder) {
  for (const auto& [name, reason] : std::vector<std::pair<std::string, std::string>>{
           {"throws_in_score", "acquisition/throws_in_score: no score today"},
           {"reads_untold",
            "acquisition/reads_untold: reads the weight w, which its reads() does not name, add it there"},
           {"throws_number_in_score", "acquisition/throws_number_in_score: threw something that is no exception"}}) {
    const TemporaryFolder here;
    here.write("exp.yaml", config_with("acquisition", name));
    const Ended ended = palpate({"run", "exp.yaml"}, here.path(), search(bad_plugin_folder(name)));
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_EQ(ended.err, reason + "\n");
    const Ended status =
        palpate({"status", only_run(here.path() / "runs").string()}, here.path(), search(bad_plugin_folder(name)));
    EXPECT_THAT(status.out + status.err, HasSubstr("failed"));
    EXPECT_THAT(status.out + status.err, HasSubstr(reason));
  }
}

}  // namespace
}  // namespace palpate::test
