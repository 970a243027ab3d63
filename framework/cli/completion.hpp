// SPDX-License-Identifier: MIT
// What may be typed next: commands and their options, configs, groups, keys with their meaning, values, plugins, runs.
// The scripts in cli/shells ask for it, at every press of the tabulator, and offer files where there is nothing.
#pragma once

#include "cli/program.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::cli {

/// One way to go on.
struct Completion {
  std::string word;     ///< the whole word; one that ends in '=', '.', '/' or ',' goes on
  std::string meaning;  ///< one line; may be ""
};

/// Returns the completions of the last of `words`, which stand behind `palpate` and of which the last may be empty or
/// half typed. Nothing is written, run or built; a config or plugin that is broken is as if it were not there. Opens at
/// most the plugins whose options are asked for.
std::vector<Completion> completions(CLI::App& app, Program& program, const std::vector<std::string>& words);

}  // namespace palpate::cli
