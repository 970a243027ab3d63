// SPDX-License-Identifier: MIT
// `--watch` starts a process that serves the page of a run or sweep.
#pragma once

#include "cli/command_context.hpp"
#include "experiment/tap_record.hpp"

#include <filesystem>

namespace palpate::cli {

/// Starts `palpate watch DIRECTORY --until-left`. Prints the address of the page on stderr. If the page cannot be
/// served, prints the reason instead and does not fail. The started process ignores the signals of the terminal and
/// outlives this process.
void start_watcher(const CommandEnvironment& program, const std::filesystem::path& directory);

/// Starts the watcher right before the first tap, because the directory of the run does not exist earlier.
class Watcher final : public Observer {
 public:
  /// `program` must outlive this object.
  Watcher(const CommandEnvironment& program, std::filesystem::path directory)
      : program_(program), directory_(std::move(directory)) {}

  void start();
  void announce(const TapRecord&) override { start(); }

 private:
  const CommandEnvironment& program_;
  std::filesystem::path directory_;
  bool started_ = false;
};

}  // namespace palpate::cli
