// SPDX-License-Identifier: MIT
#include "cli/bundle_plugins.hpp"

#include "children/child_process.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

namespace palpate::cli {

namespace fs = std::filesystem;

namespace {

/// Runs a program to its end. Throws Error with the end of its output if it fails.
void perform(const std::vector<std::string>& words) {
  const std::unique_ptr<ChildProcess> child = ChildProcess::start({words});
  if (child && child->wait() && child->status() == 0) return;
  constexpr std::size_t kShown = 300;
  const std::string said = child ? child->said() : "it cannot be started";
  throw Error(fmt::format("{}", fmt::join(words, " ")),
              "failed: " + one_line(said.substr(said.size() - std::min(kShown, said.size()))),
              "the sources of the bundle need CMake and a compiler", Error::Kind::run);
}

/// Asks whether code of the bundle may be run. Without a terminal, --with-plugins is the answer.
void ask(const std::vector<fs::path>& sources) {
  if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDERR_FILENO) == 0) return;
  std::string names;
  for (const fs::path& one : sources) names += "  " + one.filename().string() + "\n";
  flush_output();
  print_message("The bundle contains code, which can do anything that you can do:\n" + names + "Run it? [y/N] ");
  std::string answer;
  std::getline(std::cin, answer);
  if (answer != "y" && answer != "yes")
    throw Error("command line", "--with-plugins: the code of the bundle is not run", "verify without --with-plugins");
}

/// Returns the prefix of the installation. A build tree is installed into `scratch` first.
fs::path installed_prefix(const Installation& installation, const fs::path& scratch) {
  const fs::path folder = installation.program.parent_path();
  if (installation.whole == installation.program) return folder.parent_path();
  perform({"cmake", "--install", folder.string(), "--prefix", (scratch / "palpate").string()});
  return scratch / "palpate";
}

}  // namespace

BundlePlugins::BundlePlugins(const CommandEnvironment& program, const UnpackedBundle& bundle, bool builds) {
  std::vector<fs::path> folders{program.installation.plugins};
  const std::vector<fs::path> sources = builds ? list_folder(bundle.folder() / "sources") : std::vector<fs::path>();
  if (!sources.empty()) ask(sources);
  fs::path prefix;
  for (const fs::path& source : sources) {
    const auto list = read_if_there(source / "CMakeLists.txt", kMostConfigBytes);
    if (!list || list->find("palpate_add_plugin") == std::string::npos) continue;  // programs need no build
    if (prefix.empty()) prefix = installed_prefix(program.installation, builds_.path());
    const fs::path build = builds_.path() / source.filename();
    perform({"cmake", "-S", source.string(), "-B", build.string(), "-DCMAKE_BUILD_TYPE=Release",
             "-DCMAKE_PREFIX_PATH=" + prefix.string()});
    perform({"cmake", "--build", build.string()});
    folders.push_back(build / "lib" / "palpate");
  }
  host_.emplace(folders);
  program_.emplace(
      CommandEnvironment{{*host_, program.installation, program.command_line, program.interrupted}, program.composer});
}

}  // namespace palpate::cli
