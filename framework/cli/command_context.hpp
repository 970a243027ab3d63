// SPDX-License-Identifier: MIT
// Parts that all commands share: exit statuses, the plugins and configs of the program, and delegation. Delegation
// means that `palpate` starts `palpate-whole` for commands that only `palpate-whole` has.
#pragma once

#include "config/compose.hpp"
#include "record/run.hpp"

#include <filesystem>

namespace palpate::cli {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kBusy = 75;
constexpr int kInterrupted = 130;

/// The environment in which a command is performed.
struct CommandEnvironment : RunEnvironment {
  Composer& composer;
};

/// Replaces this process by `palpate-whole` with the same command line. Throws Error if that program is not built.
[[noreturn]] void delegate_to_whole(const CommandEnvironment& program);

/// Calls a function of `palpate-whole`. In `palpate` its address is null (see PALPATE_WHOLE), and the command is
/// delegated.
template <class Result, class... Parameters, class... Arguments>
Result call_in_whole(Result (*function)(CommandEnvironment&, Parameters...), CommandEnvironment& program,
                     const Arguments&... arguments) {
  if (function == nullptr) delegate_to_whole(program);
  return function(program, arguments...);
}

/// Declares a function that only `palpate-whole` defines. In `palpate`, the linker sets the address of the function to
/// null. A first run after cloning therefore needs only `palpate`, and does not wait until sweeps and pages are
/// compiled.
#define PALPATE_WHOLE [[gnu::weak]]

/// Throws Error if `directory` is a sweep. Commands that read one run call this function. The hint of the error names
/// the folders of the sweep's runs.
void check_one_run(const std::filesystem::path& directory);

}  // namespace palpate::cli
