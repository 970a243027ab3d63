// SPDX-License-Identifier: MIT
// `--watch`: the page of what a command begins, served by a process of its own.
#pragma once

#include "cli/program.hpp"
#include "experiment/tap_record.hpp"

#include <filesystem>

namespace palpate::cli {

/// Starts `palpate watch DIRECTORY --until-left` and prints the address on stderr, once it is there, or why there is
/// none: nothing else depends on it. It hears none of the terminal's signals and outlives this process.
void start_watcher(const Program& program, const std::filesystem::path& directory);

/// Starts it once the run has begun, before its first tap: until then the directory is not there, and nothing says that
/// the run begins at all.
class Watcher final : public Journal {
 public:
  /// `display` may be null; both must outlive it.
  Watcher(const Program& program, std::filesystem::path directory, Journal* display)
      : program_(program), directory_(std::move(directory)), display_(display) {}

  void start();
  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;
  bool wants_errors() const override { return display_ != nullptr && display_->wants_errors(); }

 private:
  const Program& program_;
  std::filesystem::path directory_;
  Journal* display_;
  bool started_ = false;
};

}  // namespace palpate::cli
