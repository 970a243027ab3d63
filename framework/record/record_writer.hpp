// SPDX-License-Identifier: MIT
// Writer of record.jsonl, the record of a run. The writer locks the file, so that no other process can write to it.
#pragma once

#include "config/tree.hpp"
#include "record/files.hpp"
#include "record/record_reader.hpp"
#include "record/row.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Appends complete lines with one system call each, and never changes a line. The methods that write throw Error if
/// another process may be writing too (see FileLock::check()) or if writing fails. The record is then unchanged, unless
/// only the sync failed.
class RecordWriter {
 public:
  /// Makes the directory if it does not exist, and locks its record. Throws Error of kind `busy` if another process has
  /// locked it.
  explicit RecordWriter(const std::filesystem::path& directory);

  /// Returns the record that earlier processes wrote. Reads the file at the first call only. Throws Error as
  /// RecordReader does.
  const RunRecord& before();

  /// Returns whether the record now has a manifest.
  bool begun() const { return begun_; }
  /// Returns whether the last line of the record is now an `end`.
  bool ended() const { return ended_; }

  /// Throws Error if the path of the directory no longer leads to the directory that was opened.
  void check_in_place() const { lock_.check_in_place(); }
  void check_held() const { lock_.check(); }

  /// Deletes all lines, so that a run that failed before it could begin can begin again.
  void clear();
  /// Appends the first line. The first entry of `manifest` has the key `manifest`.
  void add_manifest(const Tree& manifest, bool sync);
  /// Appends the line of this process's attempt, before all other lines except the manifest. `attempt` holds further
  /// fields besides number, time and taps. If a kill or a full disk left an incomplete last line, this line is deleted
  /// first. The field `cut` then contains its number of bytes.
  void add_attempt(const Row& attempt);
  /// Appends the line `setup` of this attempt. Call this after the experiment is built. `models` lists, for each model,
  /// the parts of the run that read it.
  void add_setup(bool announces, const Tree& models, bool sync);
  /// Appends the line of a tap that was made, or of an intent, which announces a tap. With `sync`, the line is on the
  /// disk when the function returns.
  void add_tap(const Row& tap, bool sync);
  /// Appends the times of the tap. The times are appended separately, so that a nearly full disk can still store the
  /// tap.
  void add_timing(const TapTimes& times);
  void add_objects(const std::vector<Row>& objects, bool sync);
  /// Appends a line whose first field is `note` with the value `kind`, followed by the fields of `note`.
  void add_note(const std::string& kind, const Row& note, bool sync);
  /// Appends the line `end`, which defines the final state of the run. Call this after all other writes. When the
  /// function returns, the file system has accepted all lines of the record.
  void add_end(const Ending& ending, bool sync);

  /// Syncs the directory entries on the path of the record to the disk.
  void sync_name() const;

 private:
  AppendFile& log();
  void append(const std::string& lines, bool sync);

  std::filesystem::path directory_;
  FileLock lock_;
  std::optional<RunRecord> before_;
  std::optional<AppendFile> log_;
  bool begun_ = false;  ///< whether the record has a manifest, from an earlier process or this one
  bool ended_ = false;  ///< whether the last line is an `end`
  std::int64_t attempts_ = 0;
  std::uintmax_t cut_ = 0;  ///< bytes of the incomplete last line that were deleted
};

/// Returns the current UTC time in the format of records: 2026-11-24T23:59:28Z.
std::string now_text();

}  // namespace palpate
