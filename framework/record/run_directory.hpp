// SPDX-License-Identifier: MIT
// The directory of one run: its record, the files that are made from it, and what state it is in. runs/README.md
// describes every file.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/files.hpp"
#include "record/record_writer.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Whether `directory` is that of a sweep, and so of many runs.
bool is_sweep(const std::filesystem::path& directory);

/// How far a run came, read from its record alone.
struct RunStatus {
  enum class State {
    absent,      ///< no such directory, or one without a record
    running,     ///< a living process holds the lock
    unfinished,  ///< killed or interrupted
    done,
    failed,
  };
  State state = State::absent;
  int taps = 0;             ///< recorded
  std::string stop_reason;  ///< of a finished run: why it stopped or failed
  /// The last RMSE that is known to have been expected, metres: of a run that ended well that of its summary, of others
  /// that before the last tap, where `palpate run` showed it.
  std::optional<double> expected_rmse = std::nullopt;
  bool cut = false;  ///< there is a summary.json, and the record does not say that the run has ended
  std::optional<Ending> end = std::nullopt;  ///< of a finished run
};

/// The summary of a run that has ended, as the last line of its record has it; none of another. Throws Error for a
/// damaged line.
std::optional<Row> read_summary(const std::filesystem::path& directory);

/// The same for who looks at many: a damaged one is that of a failed run, with the damage for its reason. Throws Error
/// where the file system fails.
std::optional<Row> read_outcome(const std::filesystem::path& directory);

/// State and reason of a run directory, as the last line of its record tells them: the taps are not counted, and it is
/// not asked who holds it. Of a damaged line, as read_outcome().
RunStatus read_ending(const std::filesystem::path& directory);

/// The same, and of one that is not done whether a living process holds it.
RunStatus read_standing(const std::filesystem::path& directory);

/// Whether a file that was made from the record of an ended run is gone, or has not as many bytes as it had: a kill or
/// a power cut came between.
bool lacks_files(const std::filesystem::path& directory, const Ending& end);

/// Whether a living process holds it.
bool is_running(const std::filesystem::path& directory);

/// Reads the state of a run directory; nobody seems to hold it, because it is not asked who does. For who holds the
/// lock. Throws Error for a damaged one.
RunStatus read_record(const std::filesystem::path& directory);

/// The same, and whether it is running. Throws Error for a damaged one.
RunStatus read_status(const std::filesystem::path& directory);

const char* state_name(RunStatus::State state);

/// A run directory held by this process. Keeps the lock for its lifetime.
class RunDirectory final {
 public:
  /// Makes the directory if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit RunDirectory(const std::filesystem::path& directory);

  const std::filesystem::path& path() const { return path_; }

  /// What earlier processes have recorded. Throws Error for a damaged record.
  const RunRecord& before() { return record_.before(); }

  /// From here on all that is written is forced to disk. Throws Error.
  void sync() { sync_ = true; }

  /// Takes everything out of the record of a run that failed before it could begin.
  void clear() { record_.clear(); }

  /// The config, before the record begins: on the disk on return, since a record without one cannot be carried on.
  void write_config(const std::string& text) const;

  /// The beginning of a record. `manifest` holds what there is to know beside its version.
  void begin(const Tree& manifest);

  /// An attempt of this process, before it builds anything; `build` is its own.
  void begin_attempt(const std::string& build, bool forced);

  /// The same once it is built. With `announce` each tap is announced before it is made.
  void set_up(bool announce, const Tree& models);

  /// The taps that are recorded. One that was announced, and of which nobody saw the end, becomes a tap of outcome
  /// `unknown`. Throws Error for a tap that is none.
  std::vector<TapRecord> recover();

  /// Throws Error where the directory is no longer the one that was opened: nothing more can be recorded.
  void check_in_place() const { record_.check_in_place(); }

  void announce(const TapRecord& tap);
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds);

  /// What the taps have shown of the robot.
  void note_learnt(const std::string& name, const std::string& value);
  void write_objects(const std::vector<Row>& objects) { record_.add_objects(objects, sync_); }

  /// The rows of all taps, recovered ones included.
  const std::vector<Row>& rows() const { return rows_; }

  /// Seconds by phase of all taps, those of earlier processes included.
  std::array<double, kPhases> total_seconds() const { return total_; }

  void write(const std::string& name, const std::string& text) const {
    record_.check_in_place();
    write_file(path_ / name, text, sync_);
  }
  /// A file that is made from the record: end() records how many bytes it has and their hash.
  void write_made(const std::string& name, const std::string& text);

  /// Records how the run, or this attempt, ended, with its summary unless it was interrupted, and the files of
  /// write_made(); then writes the summary into summary.json.
  void end(Ending ending);

  /// Ends a run that failed before it could begin, or whose process died, and whose record may be damaged.
  void fail(const std::string& reason);

 private:
  std::filesystem::path path_;
  HeldRecord record_;
  std::vector<Row> rows_;
  std::array<double, kPhases> total_{};
  std::vector<Ending::File> made_;
  bool announce_ = false;
  bool sync_ = false;
};

}  // namespace palpate
