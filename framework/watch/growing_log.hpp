// SPDX-License-Identifier: MIT
// Reader of a run's record while another process writes it.
#pragma once

#include "record/record_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

namespace palpate {

/// The lines of a growing record. A line without a line end is ignored. A killed process may leave an incomplete line
/// behind; `palpate resume` removes this line.
class GrowingLog {
 public:
  explicit GrowingLog(std::filesystem::path file) : reader_(std::move(file)) {}

  const std::filesystem::path& file() const { return reader_.file(); }

  /// Returns the lines that were added since the last call. If the file is gone or no longer begins with the known
  /// lines, sets `anew` and returns all lines of the file. Throws the errors of RecordReader. If the file changes after
  /// an error, the next call begins at the start of the file.
  std::vector<RecordLine> read(bool& anew);

  /// Makes the next read() begin at the start of the file.
  void restart() { stamp_ = {}, known_.clear(); }

 private:
  /// inode, size in bytes, and modification time (seconds, nanoseconds) of the file
  using Stamp = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t>;

  RecordReader reader_;
  Stamp stamp_{};
  std::string known_;  ///< text of all lines so far, to detect any rewriting of the file
};

}  // namespace palpate
