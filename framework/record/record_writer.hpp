// SPDX-License-Identifier: MIT
// The record of a run held by this process, which adds to it: the one writer of record.jsonl.
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

/// Lines are written whole, each with one call, and none is ever changed. Every method that writes throws Error where
/// another process may be writing there, as FileLock::check() says, and where writing fails; then the record is as it
/// was, unless only the sync failed.
class HeldRecord {
 public:
  /// Makes the directory if need be and locks its record. Throws Error of kind `busy` if another process holds it.
  explicit HeldRecord(const std::filesystem::path& directory);

  /// What is recorded by earlier processes. Read once. Throws Error as RecordReader does.
  const RunRecord& before();

  /// Whether there is a manifest, and whether the last line is an end, by now.
  bool begun() const { return begun_; }
  bool ended() const { return ended_; }

  /// Throws Error where the directory is no longer the one that was opened: nothing more can be recorded.
  void check_in_place() const { lock_.check_in_place(); }
  void check_held() const { lock_.check(); }

  /// Takes everything out, for a run that failed before it could begin: it begins anew.
  void clear();
  /// Its first entry is `manifest`.
  void add_manifest(const Tree& manifest, bool sync);
  /// An attempt of this process, noted before anything else it does. `attempt` has what there is to know beside number,
  /// time and taps; what a kill or a full disk left of a last line is cut off, and noted as `cut`, bytes.
  void add_attempt(const Row& attempt);
  /// The same attempt, once the experiment is built. `models`: who reads which.
  void add_setup(bool announces, const Tree& models, bool sync);
  /// A tap, or one that is announced. With `sync` it is on the disk on return.
  void add_tap(const Row& tap, bool sync);
  /// Its times, behind it. A call of its own: a disk that has room for the tap alone keeps that.
  void add_timing(const TapTimes& times);
  void add_objects(const std::vector<Row>& objects, bool sync);
  /// One line each; `kind` is the value of `note`.
  void add_note(const std::string& kind, const Row& note, bool sync);
  /// What all readers take the state of the run from: written when all else is on its way to the disk. Every write
  /// before it, and then this one, is taken by the file system on return.
  void add_end(const Ending& ending, bool sync);

  /// Puts the name of the record on the disk, too.
  void sync_name() const;

 private:
  AppendFile& log();
  void append(const std::string& lines, bool sync);

  std::filesystem::path directory_;
  FileLock lock_;
  std::optional<RunRecord> before_;
  std::optional<AppendFile> log_;
  bool begun_ = false;  ///< there is a manifest, of this process, too
  bool ended_ = false;  ///< the last line is an end
  std::int64_t attempts_ = 0;
  std::uintmax_t cut_ = 0;  ///< bytes that were cut off
};

/// Returns the time now as records have it: UTC, 2026-11-24T23:59:28Z.
std::string now_text();

}  // namespace palpate
