// SPDX-License-Identifier: MIT
// The log of a run, read while somebody else writes it.
#pragma once

#include "record/row.hpp"
#include "record/run_files.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

namespace palpate {

/// The taps of a run as they grow: taps.jsonl, or of a job record.jsonl. A line counts once it has its end, so half a
/// line, which a kill leaves behind and `palpate resume` cuts off, is never seen.
class GrowingLog {
 public:
  explicit GrowingLog(std::filesystem::path file) : lines_(std::move(file)) {}

  const std::filesystem::path& file() const { return lines_.file(); }

  /// The taps that were recorded since the last call; announcements are left out. `anew` becomes true where the file no
  /// longer begins with what was read before, or is gone: then the taps are all that it has now. Throws Error for a
  /// line that is none or out of order; once the file has changed, the next call begins at the beginning.
  std::vector<Row> read(bool& anew);

  /// Has the next read() begin at the beginning.
  void forget() { stamp_ = {}, known_.clear(); }

 private:
  using Stamp = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t>;  ///< file, size, time

  TapLines lines_;
  Stamp stamp_{};
  std::string known_;  ///< all lines so far: what was rewritten must be noticed, however it was
};

}  // namespace palpate
