// SPDX-License-Identifier: MIT
// The output of a run on the terminal: one line per tap, and the summary.
#pragma once

#include "record/run.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate::cli {

/// Prints one line per tap on stdout. On a terminal, also shows a live line during the tap.
class TapTable final : public Observer {
 public:
  explicit TapTable(std::int64_t budget);
  bool wants_errors() const override { return true; }
  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;

 private:
  void clear_live_line() const;

  std::int64_t budget_;
  bool terminal_;
  bool header_ = false;
};

/// Terminal codes that return to the beginning of the line and erase the line.
constexpr std::string_view kClearLine = "\r\x1b[K";

/// Returns the result of printable() for `text`, except that kClearLine at its beginning is kept.
std::string displayable(std::string_view text);

/// Writes a message about the progress of the work on stderr, after conversion by displayable(). Ignores a failure, for
/// example because the terminal was closed (fmt::print would throw).
void print_message(const std::string& text);

/// Returns a line with the path of the record, or with the command that resumes the run.
std::string record_line(const RunConclusion& report);

/// Prints the result of a run in a few lines.
void print_summary(const RunConclusion& report);

}  // namespace palpate::cli
