// SPDX-License-Identifier: MIT
// A run's record that another process writes.
#pragma once

#include "record/record_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

namespace palpate {

/// The lines of a growing record. A line without its line end is ignored: a kill leaves such a line behind, and
/// `palpate resume` removes it.
class GrowingLog {
 public:
  explicit GrowingLog(std::filesystem::path file) : reader_(std::move(file)) {}

  const std::filesystem::path& file() const { return reader_.file(); }

  /// Returns the lines that were added since the last call. If the file is gone or no longer begins with the known
  /// lines, sets `anew` and returns all its lines. Throws Error as RecordReader does; after a change of the file, the
  /// next call then begins at its start.
  std::vector<RecordLine> read(bool& anew);

  /// Makes the next read() begin at the start of the file.
  void restart() { stamp_ = {}, known_.clear(); }

 private:
  using Stamp = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t>;  ///< inode, size, time

  RecordReader reader_;
  Stamp stamp_{};
  std::string known_;  ///< all lines so far, to detect any rewriting of the file
};

}  // namespace palpate
