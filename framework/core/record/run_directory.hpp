// SPDX-License-Identifier: MIT
// The directory of one run: its lock, its files, and what state it is in. runs/README.md describes every file.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/files.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"
#include "record/run_files.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Whether `directory` is that of a sweep, and so of many runs.
bool is_sweep(const std::filesystem::path& directory);

/// How far a run came, read from its directory alone.
struct RunStatus {
  enum class State {
    absent,      ///< no such directory, or one without a tap
    running,     ///< a living process holds the lock
    unfinished,  ///< killed or interrupted
    done,
    failed,
  };
  State state = State::absent;
  int taps = 0;             ///< recorded
  std::string stop_reason;  ///< of a finished run: why it stopped or failed
};

/// Its summary.json; none for a run that has not ended. Throws Error for a damaged one.
std::optional<Row> read_summary(const std::filesystem::path& directory);

/// The same for who looks at many: a damaged one is that of a failed run, with the damage for its reason. Throws Error
/// where the file system fails.
std::optional<Row> read_outcome(const std::filesystem::path& directory);

/// Throws Error if `summary` is that of a finished run in `directory` with more taps than are `recorded`.
void check_complete(const Row& summary, int recorded, const std::filesystem::path& directory);

/// State and reason of a run directory, as cheaply as they can be told: the taps are not counted, and it is not asked
/// who holds it. Of a damaged summary, as read_outcome().
RunStatus read_ending(const std::filesystem::path& directory);

/// Whether a living process holds it.
bool is_running(const std::filesystem::path& directory);

/// Reads the state of a run directory; nobody seems to hold it, because it is not asked who does. For who holds the
/// lock. Throws Error for a damaged one.
RunStatus read_record(const std::filesystem::path& directory);

/// The same, and whether it is running. Throws Error for a damaged one.
RunStatus read_status(const std::filesystem::path& directory);

const char* state_name(RunStatus::State state);

/// A run directory held by this process. Keeps the lock for its lifetime.
class RunDirectory final : public Journal {
 public:
  /// Makes the directory if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit RunDirectory(const std::filesystem::path& directory);

  const std::filesystem::path& path() const { return path_; }

  /// All of the record but config, summary and tables.
  HeldFiles& files() { return files_; }

  /// Reads the recorded taps and cuts off what a kill left behind: half a line, or an intent without its result, which
  /// becomes a tap of outcome `unknown`. Throws Error for a damaged file.
  std::vector<PastTap> recover();

  /// From here on all that is written is forced to disk. Throws Error.
  void sync();

  /// Opens the log for what follows. With `announce` each tap is announced before it is made.
  void open(bool announce);

  /// Throws Error where the directory is no longer the one that was opened: nothing more can be recorded.
  void check_in_place() const { files_.check_in_place(); }

  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;

  /// The rows of all taps, recovered ones included.
  const std::vector<Row>& rows() const { return rows_; }

  /// Seconds by phase of all taps, those of earlier processes included.
  std::array<double, kPhases> total_seconds() const { return total_; }

  template <class T>  // a text, or a Text
  void write(const std::string& name, const T& text) const {
    files_.check_held();
    write_file(path_ / name, text, sync_);
  }
  void write_manifest(const Tree& manifest) { files_.set_manifest(manifest, sync_); }
  void write_objects(const std::vector<Row>& objects) { files_.set_objects(objects, sync_); }

 private:
  std::filesystem::path path_;
  HeldFiles files_;
  std::vector<Row> rows_;
  std::array<double, kPhases> total_{};
  bool announce_ = false;
  bool sync_ = false;
};

}  // namespace palpate
