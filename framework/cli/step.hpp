// SPDX-License-Identifier: MIT
// `--step`: a person at a terminal sees every tap before it is made, and lets it be made or ends the run.
#pragma once

#include "record/session.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <string>

namespace palpate::cli {

/// Shows each tap on stderr and waits for a line on stdin.
class Step final : public Supervisor {
 public:
  /// None unless `wanted`. Throws Error without a terminal to show and to ask: before anything is connected or moves.
  static std::unique_ptr<Step> when(bool wanted, const ExperimentOptions& options,
                                    const std::atomic<bool>* interrupted);

  /// True for Enter; false for q, Ctrl-D, and whatever sets `interrupted`. What was typed before the question is no
  /// answer to it.
  bool permits(const TapRecord& tap, const Preview& preview) override;

 private:
  Step(const ExperimentOptions& options, const std::atomic<bool>* interrupted);
  std::optional<std::string> read_line() const;

  std::int64_t budget_;
  bool two_part_;
  const std::atomic<bool>* interrupted_;
};

}  // namespace palpate::cli
