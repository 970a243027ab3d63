// SPDX-License-Identifier: MIT
// `--step`: each tap is shown on the terminal and waits for the permission of the user.
#pragma once

#include "record/run.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <string>

namespace palpate::cli {

/// Shows each tap on stderr and waits for a line on stdin.
class Step final : public Observer {
 public:
  /// Returns null unless `wanted`. Throws Error without a terminal, before a connection is made or anything moves.
  static std::unique_ptr<Step> when(bool wanted, const ExperimentOptions& options,
                                    const std::atomic<bool>* interrupted);

  /// Returns true for Enter; false for q, for Ctrl-D, and once `interrupted` is set. Input from before the question is
  /// discarded.
  bool permits(const TapRecord& tap, const Experiment& experiment) override;

 private:
  Step(const ExperimentOptions& options, const std::atomic<bool>* interrupted);
  std::optional<std::string> read_line() const;

  std::int64_t budget_;
  bool two_part_;
  const std::atomic<bool>* interrupted_;
};

}  // namespace palpate::cli
