// SPDX-License-Identifier: MIT
// How this build compiles its files, by the list that CMake writes.
#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>

namespace palpate {
namespace {

using nlohmann::json;

/// Options of a compiler that precompiled headers depend on, as g++ 14 compares them: the last optimisation, features
/// of language, code and processor. Of -fPIC and -fPIE it takes either.
std::string flags_of(const std::string& command) {
  std::istringstream words(command);
  std::string optimisation;
  std::string rest;
  for (std::string word; words >> word;) {
    if (word.rfind("-O", 0) == 0) optimisation = word;
    if (word.rfind("-f", 0) == 0 || word.rfind("-m", 0) == 0 || word.rfind("-std=", 0) == 0) rest += " " + word;
  }
  return optimisation + rest;
}

// g++ 14 rejects other precompiled headers: where CI=true nothing is built then, elsewhere a third of the time is lost.
TEST(Build, FilesAreCompiledWithTheFlagsOfTheirPrecompiledHeaders) {
  if (test::kSanitized)
    GTEST_SKIP() << "tests repeat the flags of sanitizers, or leave some out, and nobody else builds so";
  const auto file = test::program_file().parent_path() / "compile_commands.json";
  const json commands = json::parse(test::text_of(file));
  const std::string ending = ".cxx";
  std::map<std::string, std::string> flags;  // of each precompiled header
  for (const json& one : commands) {
    const std::string source = one["file"];
    if (source.find("/cmake_pch.hxx") != std::string::npos)
      flags[source.substr(0, source.size() - ending.size())] = flags_of(one["command"]);
  }
  int users = 0;
  for (const json& one : commands) {
    const std::string command = one["command"];
    const std::string source = one["file"];
    if (source.find("/cmake_pch.hxx") != std::string::npos) continue;
    for (const auto& [header, its_flags] : flags) {
      if (command.find(" -include " + header + " ") == std::string::npos) continue;
      ++users;
      EXPECT_EQ(flags_of(command), its_flags) << source << "\nincludes " << header;
    }
  }
  EXPECT_GT(users, 50);
}

}  // namespace
}  // namespace palpate
