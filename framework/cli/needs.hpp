// SPDX-License-Identifier: MIT
// What a command line needs beside `palpate` itself. ./palpate asks, with --needs before the other words, and has that
// built; the program never compiles anything.
#pragma once

#include "cli/commands.hpp"

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate::cli {

struct Needs {
  bool whole = false;                                     ///< the program with every command
  bool every_plugin = false;                              ///< of this build
  std::set<std::pair<std::string, std::string>> plugins;  ///< kind and name
};

// Each of these adds to `needs` what a command takes, and throws nothing: what is wrong with a config the command says.
// Plugins that only plugins name come to light once those are built.

/// The plugins that a config names, by itself or because they are defaults; with `sweeps`, everything where it is one.
void need_config(Program& program, const std::string& config, const std::vector<std::string>& overrides, bool sweeps,
                 Needs& needs);
/// What a run named; everything for a sweep.
void need_record(Program& program, const std::string& directory, Needs& needs);
/// That, and the program with every command.
void need_whole(Program& program, const std::string& directory, Needs& needs);
/// The plugins that `palpate plugins` lists: "", KIND or KIND/NAME.
void need_listing(Program& program, const std::string& what, Needs& needs);
/// Both: what the jobs of a sweep name is only known once it is planned.
void need_everything(Program& program, Needs& needs);

/// Prints the targets of the build, one a line. Nothing where the program is installed and has all.
void print_needs(const Program& program, const Needs& needs);

}  // namespace palpate::cli
