// SPDX-License-Identifier: MIT
// `--watch`: starts a process that serves the page of a run or sweep.
#pragma once

#include "cli/program.hpp"
#include "experiment/tap_record.hpp"

#include <filesystem>

namespace palpate::cli {

/// Starts `palpate watch DIRECTORY --until-left`. Prints on stderr the address of the page, or the reason why there is
/// none, which is not an error. The process ignores the terminal's signals and outlives this process.
void start_watcher(const Program& program, const std::filesystem::path& directory);

/// Starts the watcher right before the first tap, because the run directory does not exist earlier.
class Watcher final : public Observer {
 public:
  /// `program` must outlive this object.
  Watcher(const Program& program, std::filesystem::path directory)
      : program_(program), directory_(std::move(directory)) {}

  void start();
  void announce(const TapRecord&) override { start(); }

 private:
  const Program& program_;
  std::filesystem::path directory_;
  bool started_ = false;
};

}  // namespace palpate::cli
