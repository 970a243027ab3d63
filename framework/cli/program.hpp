// SPDX-License-Identifier: MIT
// What all commands share: exit statuses, the plugins and configs of the program, and the delegation of a command to
// the program that has it.
#pragma once

#include "config/compose.hpp"
#include "host/host.hpp"
#include "record/run.hpp"

#include <filesystem>

namespace palpate::cli {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kBusy = 75;
constexpr int kInterrupted = 130;

/// The environment of a command.
struct Program : RunEnvironment {
  Composer& composer;
};

/// Replaces this process by `palpate-whole`, with the same command line. Throws Error if that program is not built.
[[noreturn]] void delegate_to_whole(const Program& program);

/// Calls a function of `palpate-whole`, which is null in `palpate` (see PALPATE_WHOLE), where it delegates.
template <class Result, class... Parameters, class... Arguments>
Result call_in_whole(Result (*function)(Program&, Parameters...), Program& program, const Arguments&... arguments) {
  if (function == nullptr) delegate_to_whole(program);
  return function(program, arguments...);
}

/// Declares a function that only `palpate-whole` defines. The first run of a clone needs `palpate` alone, and so waits
/// for the compilation of neither sweeps nor pages. The linker sets the address of the function to null in `palpate`.
#define PALPATE_WHOLE [[gnu::weak]]

/// Throws Error if `directory` is a sweep, for commands that read one run. The hint names the folders of its runs.
void check_one_run(const std::filesystem::path& directory);

}  // namespace palpate::cli
