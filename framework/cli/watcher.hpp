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
class Watcher final : public Journal {
 public:
  /// `display` may be null. Both objects must outlive this one.
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
