// SPDX-License-Identifier: MIT
// What a command line needs beside `palpate` itself. ./palpate asks, with --needs before the other words, and has that
// built; the program never compiles anything.
#pragma once

#include "cli/program.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

/// Gathers what a command takes; it is a source of plugins that notes for which ones it is asked. No member throws:
/// what is wrong with a config the command says. Plugins that only plugins name come to light once those are built.
class Needs final : public PluginSource {
 public:
  explicit Needs(Program& program) : program_(program) {}

  /// The program with every command.
  void whole() { whole_ = true; }
  /// All of this build.
  void every_plugin() { every_plugin_ = true; }
  /// Both: what the jobs of a sweep name is only known once it is planned.
  void everything() { whole_ = every_plugin_ = true; }
  /// The plugins that a config names, by itself or because they are defaults; with `sweeps`, everything where it is
  /// one.
  void config(const std::string& file, const std::vector<std::string>& overrides, bool sweeps);
  /// What a run named; everything for a sweep.
  void record(const std::string& directory);
  void whole_and_record(const std::string& directory) {
    whole();
    record(directory);
  }
  /// The plugins that `palpate plugins` lists: "", KIND or KIND/NAME.
  void listing(const std::string& what);

  /// Prints the targets of the build, one a line. Nothing where the program is installed and has all.
  void print() const;

  /// What is not built is silent about its options.
  bool is_silent(const std::string& kind, const std::string& name) const override;
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override;

 private:
  Program& program_;
  bool whole_ = false;
  bool every_plugin_ = false;
  mutable PluginNames plugins_;
};

}  // namespace palpate::cli
