// SPDX-License-Identifier: MIT
// What a person sees of a run while it goes on, and at its end.
#pragma once

#include "record/session.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate::cli {

/// Prints a line a tap on stdout; on a terminal also a live line while the tap is under way.
class TapTable final : public Journal {
 public:
  explicit TapTable(std::int64_t budget);
  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;

 private:
  void clear_live_line() const;

  std::int64_t budget_;
  bool terminal_;
  bool header_ = false;
};

/// Takes the line of a terminal away on which something was shown for a while.
constexpr std::string_view kClearLine = "\r\x1b[K";

/// Returns `text` as printable() has it, but for kClearLine, which it may begin with.
std::string displayable(std::string_view text);

/// Writes on stderr, as displayable() has it, what only accompanies the work. That nobody can read it any more, because
/// the terminal is closed, is no reason to break the work off, as fmt::print would.
void mention(const std::string& text);

/// Where the record of a run is, or how it goes on.
std::string record_line(const RunReport& report);

/// The result of a run in a few lines.
void print_summary(const RunReport& report);

}  // namespace palpate::cli
