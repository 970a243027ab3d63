// SPDX-License-Identifier: MIT
#include "cli/command_context.hpp"

#include "cli/interrupt.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <unistd.h>

namespace palpate::cli {

void delegate_to_whole(const CommandEnvironment& program) {
  const std::string whole = program.installation.whole.string();
  if (program.installation.program == whole) throw std::logic_error("palpate-whole lacks a command of its table");
  std::vector<std::string> words = program.command_line;
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  keep_parent();
  ::execv(whole.c_str(), pointers.data());
  const std::string reason = errno == ENOENT ? "is not built" : std::strerror(errno);
  throw Error(whole, "has this command but " + reason,
              fmt::format("build it with ./palpate, or with 'cmake --build {} --target palpate_whole'",
                          program.installation.whole.parent_path().string()));
}

void check_one_run(const std::filesystem::path& directory) {
  if (!is_sweep(directory)) return;
  const std::string jobs = (directory / "jobs").string();
  throw Error(directory.string(), "is a sweep of many runs",
              fmt::format("name one run: {0}/<id>; 'palpate list {0} --where \"seed == 3\"' finds it", jobs));
}

}  // namespace palpate::cli
