// SPDX-License-Identifier: MIT
// The directory of one run: the record, the files made from the record, and the state of the run. runs/README.md
// describes every file.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/files.hpp"
#include "record/record_writer.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Returns whether `directory` is the directory of a sweep, which contains many runs.
bool is_sweep(const std::filesystem::path& directory);

/// State and progress of a run.
struct RunStatus {
  enum class State {
    absent,      ///< there is no such directory, or it has no record
    running,     ///< a process holds the lock
    unfinished,  ///< killed or interrupted; can be resumed
    done,
    failed,
  };
  State state = State::absent;
  int taps = 0;             ///< number of recorded taps
  std::string stop_reason;  ///< reason why a finished run stopped or failed
  /// Last recorded value of the expected RMSE, metres. For a finished run, this is the value in its summary. For other
  /// runs, it is the value before the last tap; this value is recorded only if `palpate run` or `palpate resume`
  /// displayed it.
  std::optional<double> expected_rmse = std::nullopt;
  bool cut = false;  ///< summary.json exists, but the record does not contain the end of a finished run
  std::optional<Ending> end = std::nullopt;  ///< end of a finished run
};

/// Returns the summary in the last line of a run's record; nullopt unless the run is done or has failed. Throws Error
/// if this line is damaged.
std::optional<Row> read_summary(const std::filesystem::path& directory);

/// Returns the summary like read_summary(), for callers that read many runs. A run with a damaged last line counts as
/// failed, with the damage as its reason. Throws Error only if the file system fails.
std::optional<Row> read_outcome(const std::filesystem::path& directory);

/// Returns the state and the reason in the last line of a run's record. Does not count the taps and does not check the
/// lock. Treats a damaged last line as read_outcome() does.
RunStatus read_ending(const std::filesystem::path& directory);

/// Returns the same as read_ending(), except that the state is `running` if the run is not done and a process holds the
/// lock.
RunStatus read_standing(const std::filesystem::path& directory);

/// Returns whether a file that was made from the record of an ended run is missing or has another size than in `end`,
/// as after a kill or a power cut. Also returns true if summary.json is missing or empty.
bool lacks_files(const std::filesystem::path& directory, const Ending& end);

/// Returns whether a process holds the lock of the run.
bool is_running(const std::filesystem::path& directory);

/// Reads the whole record and returns the state of the run. Does not check the lock and never returns `running`, so
/// that the process that holds the lock can call it. Throws Error for a damaged record.
RunStatus read_record(const std::filesystem::path& directory);

/// Returns the same as read_record(), except that the state is `running` if the run is not done and a process holds the
/// lock. Throws Error for a damaged record.
RunStatus read_status(const std::filesystem::path& directory);

const char* state_name(RunStatus::State state);

/// A run directory that this process has locked. The object holds the lock for its lifetime.
class RunDirectory final {
 public:
  /// Makes the directory if it does not exist, locks it, and removes temporary files of killed processes. Throws Error
  /// of kind `busy` if another process holds the lock.
  explicit RunDirectory(const std::filesystem::path& directory);

  const std::filesystem::path& path() const { return path_; }

  /// Returns the record that earlier processes wrote. Throws Error for a damaged record.
  const RunRecord& before() { return record_.before(); }

  /// Makes later writes sync to the disk before they return. Lines `attempt` and `timing` are synced only with the next
  /// line.
  void sync() { sync_ = true; }

  /// Removes all lines of the record. Call this only for a run that failed before it could begin.
  void clear() { record_.clear(); }

  /// Writes config.yaml. Call this before begin(). The file is synced to the disk, because a run without a config
  /// cannot be resumed.
  void write_config(const std::string& text) const;

  /// Writes the first line of the record: the version of the format and the entries of `manifest`.
  void begin(const Tree& manifest);

  /// Records that this process begins an attempt. Call this before the experiment is built. `build` is the hash of this
  /// process's build; `forced` is whether the user gave --force.
  void begin_attempt(const std::string& build, bool forced);

  /// Records that the experiment of this attempt is built. `models` lists, for each model, the parts of the run that
  /// read it. With `announce`, each tap is announced in the record before it is made.
  void set_up(bool announce, const Tree& models);

  /// Returns the recorded taps. An announced tap without a result is recorded with the outcome `unknown` and returned,
  /// too. Throws Error for a damaged tap.
  std::vector<TapRecord> recover();

  /// Throws Error if the path no longer leads to the directory that was opened, because nothing more can then be
  /// recorded.
  void check_in_place() const { record_.check_in_place(); }

  void announce(const TapRecord& tap);
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds);

  /// Records a property of the robot that the taps have determined: see Backend::learnt().
  void note_learnt(const std::string& name, const std::string& value);
  void write_objects(const std::vector<Row>& objects) { record_.add_objects(objects, sync_); }

  /// Returns the rows of all taps, including those returned by recover().
  const std::vector<Row>& rows() const { return rows_; }

  /// Returns the seconds per phase, summed over all taps, including those of earlier processes.
  std::array<double, kPhases> total_seconds() const { return total_; }

  void write(const std::string& name, const std::string& text) const {
    record_.check_in_place();
    write_file(path_ / name, text, sync_);
  }
  /// Writes a file that is made from the record. end() records its size in bytes and its hash.
  void write_made(const std::string& name, const std::string& text);

  /// Records the end of the run or of this attempt, with its summary and the files of write_made(). Then writes the
  /// summary into summary.json. An interrupted run has no summary.
  void end(Ending ending);

  /// Records the failure of a run that failed before it could begin, or whose process died. The record may be damaged.
  void fail(const std::string& reason);

 private:
  std::filesystem::path path_;
  RecordWriter record_;
  std::vector<Row> rows_;
  std::array<double, kPhases> total_{};
  std::vector<Ending::ListedFile> made_;
  bool announce_ = false;
  bool sync_ = false;
};

}  // namespace palpate
