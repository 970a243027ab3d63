// SPDX-License-Identifier: MIT
// What a person sees of a run or a sweep while it goes on, and at its end.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <string>

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

/// Prints a live line of a sweep on a terminal, else a line per tenth, on stderr.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  void show(const SweepProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
};

/// The result of a run in a few lines.
void print_summary(const RunReport& report);

/// The table, the failures and the place of a sweep.
void print_sweep(const Sweep& sweep, const SweepReport& report, int initial_taps);

}  // namespace palpate::cli
