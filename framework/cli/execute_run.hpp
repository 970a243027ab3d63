// SPDX-License-Identifier: MIT
// Execution of one run with output on the terminal, from its first tap to its exit status. `palpate run` and `palpate
// resume` use it.
#pragma once

#include "cli/command_context.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::cli {

struct RunOutput {
  bool table = false;               ///< print one line per tap and a summary on stdout
  bool json = false;                ///< print summary.json on stdout
  std::string junit;                ///< JUnit file; "": none
  bool step = false;                ///< wait for permission before each tap
  std::filesystem::path watched{};  ///< run directory whose page another process serves; "": none
};

/// Function that starts or resumes the run with the given observers.
using RunAction = std::function<RunConclusion(const std::vector<Observer*>& observers)>;
/// Calls `action`, prints the result and checks the expectations of the config. Returns the exit status. Throws Error.
int execute_run(const CommandEnvironment& program, const ResolvedConfig& config, const RunOutput& output,
                const RunAction& action);

}  // namespace palpate::cli
