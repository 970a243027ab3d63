// SPDX-License-Identifier: MIT
// One run with its output on the terminal, from its first tap to its exit status: for `palpate run` and `palpate
// resume`.
#pragma once

#include "cli/program.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::cli {

struct RunOutput {
  bool table = false;               ///< one line per tap and a summary on stdout
  bool json = false;                ///< summary.json on stdout
  std::string junit;                ///< JUnit file; "": none
  bool step = false;                ///< wait for permission before each tap
  std::filesystem::path watched{};  ///< run directory whose page another process serves; "": none
};

/// Runs `action`, which starts or resumes the run with the given observers. Prints the result and checks the
/// expectations of the config. Returns the exit status. Throws Error.
using RunAction = std::function<RunReport(const std::vector<Observer*>& observers)>;
int execute_run(const Program& program, const ResolvedConfig& config, const RunOutput& output, const RunAction& action);

}  // namespace palpate::cli
