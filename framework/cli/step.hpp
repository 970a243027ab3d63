// SPDX-License-Identifier: MIT
// `--step` shows each tap on the terminal and waits until the user permits it.
#pragma once

#include "record/run.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <string>

namespace palpate::cli {

/// Shows each tap on stderr and then waits for a line on stdin.
class TapConfirmation final : public Observer {
 public:
  /// Returns null unless `wanted`. Throws Error if there is no terminal. Call this function before a connection to the
  /// arm is made and before anything moves.
  static std::unique_ptr<TapConfirmation> when(bool wanted, const ExperimentOptions& options,
                                               const std::atomic<bool>* interrupted);

  /// Returns true if the user presses Enter. Returns false for q, for Ctrl-D, and after `interrupted` is set. Input
  /// that was typed before the tap is shown is discarded.
  bool permits(const TapRecord& tap, const Experiment& experiment) override;

 private:
  TapConfirmation(const ExperimentOptions& options, const std::atomic<bool>* interrupted);
  std::optional<std::string> read_line() const;

  std::int64_t budget_;
  bool two_part_;
  const std::atomic<bool>* interrupted_;
};

}  // namespace palpate::cli
