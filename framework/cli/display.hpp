// SPDX-License-Identifier: MIT
// What a person sees of a run or a sweep while it goes on, and at its end.
#pragma once

#include "launch/conduct.hpp"
#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace palpate::cli {

/// Prints a line a tap on stdout; on a terminal also a live line while the tap is under way.
class TapTable final : public Journal {
 public:
  explicit TapTable(std::int64_t budget);
  bool follows_errors() const override { return true; }
  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;

 private:
  void clear_live_line() const;

  std::int64_t budget_;
  bool terminal_;
  bool header_ = false;
};

/// "12 s", "8 min", "3 h 05 min".
std::string duration_words(double seconds);

/// Writes what only accompanies the work. That nobody can read it any more, because the terminal is closed, is no
/// reason to break the work off, as fmt::print would.
void mention(const std::string& text, std::FILE* where = stderr);

/// Prints a live line of a sweep on a terminal, else a line per tenth, on stderr: done, running, failed, rate, time
/// left.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  void show(const SweepProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
  std::chrono::steady_clock::time_point begun_;
  std::chrono::steady_clock::time_point shown_;
};

/// The result of a run in a few lines.
void print_summary(const RunReport& report);

/// A line a failed job with its keys and its reason; of very many, the first.
void print_failures(const Sweep& sweep, const std::vector<SweepFailure>& failures);

/// The table, the failures and the place of a sweep; `initial_taps` as sweep_table() asks for them.
void print_sweep(const Sweep& sweep, const std::vector<Row>& results, const SweepReport& report,
                 const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate::cli
