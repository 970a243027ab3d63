// SPDX-License-Identifier: MIT
// The record of a run, read while somebody else writes it.
#pragma once

#include "record/record_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

namespace palpate {

/// The lines of a record as they grow. A line counts once it has its end, so half a line, which a kill leaves behind
/// and `palpate resume` cuts off, is never seen.
class GrowingLog {
 public:
  explicit GrowingLog(std::filesystem::path file) : reader_(std::move(file)) {}

  const std::filesystem::path& file() const { return reader_.file(); }

  /// The lines that were recorded since the last call. `anew` becomes true where the file no longer begins with what
  /// was read before, or is gone: then the lines are all that it has now. Throws Error as RecordReader does; once the
  /// file has changed, the next call begins at the beginning.
  std::vector<RecordLine> read(bool& anew);

  /// Has the next read() begin at the beginning.
  void forget() { stamp_ = {}, known_.clear(); }

 private:
  using Stamp = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t>;  ///< file, size, time

  RecordReader reader_;
  Stamp stamp_{};
  std::string known_;  ///< all lines so far: what was rewritten must be noticed, however it was
};

}  // namespace palpate
