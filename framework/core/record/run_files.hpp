// SPDX-License-Identifier: MIT
// Where the parts of a run's record are, and how they are read and added to. Each has a file: manifest.json,
// taps.jsonl, timings.csv, objects.csv, of a job attempts.jsonl, and the lock. A job of a sweep, unless an older
// palpate began it, has them as lines of one, record.jsonl, which is its lock, too: to make a file is what costs most
// in a short job. That there are these two layouts is known here and nowhere else.
#pragma once

#include "config/tree.hpp"
#include "record/fields.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/row.hpp"

#include <palpate/error.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// How long the taps took, as far as it is known: no run depends on it. A kill may have lost the last.
struct Timings {
  std::vector<TapTimes> taps;
  std::optional<Error> trouble;  ///< of a damaged line; `taps` are then those before the damage
};

/// The record of a run as it is read. Looks at the directory once, for its layout.
class RunFiles {
 public:
  explicit RunFiles(const std::filesystem::path& directory);

  /// That taps are appended to, to be named in what is said of them.
  std::filesystem::path taps_file() const { return file(kTaps); }
  /// That who runs it holds locked.
  std::filesystem::path lock_file() const { return file(kLock); }

  /// Whether taps are recorded there, or about to be.
  bool begun() const;

  /// A row per tap, announcements included, as far as the lines have their ends. Throws Error for a damaged line, and
  /// for taps that do not count 1, 2, 3 ...
  std::vector<Row> taps() const;

  Timings timings() const;

  /// None where there is none. Throws Error for a damaged one.
  std::optional<Tree> manifest() const;

  /// How often a job was begun; a damaged line was one, too.
  int attempts() const;

 protected:
  static constexpr const char* kPacked = "record.jsonl";
  static constexpr const char* kLock = "lock";
  static constexpr const char* kAttempts = "attempts.jsonl";
  static constexpr const char* kManifest = "manifest.json";
  static constexpr const char* kTaps = "taps.jsonl";
  static constexpr const char* kTimings = "timings.csv";
  static constexpr const char* kObjects = "objects.csv";

  RunFiles(const std::filesystem::path& directory, bool packed);
  /// The same of what is to be recorded there: of a job that has nothing yet, too.
  static bool will_be_packed(const std::filesystem::path& directory);

  bool packed() const { return packed_; }
  /// That of a part which the loose layout has in a file of its own.
  std::filesystem::path file(const char* loose) const { return directory_ + (packed_ ? kPacked : loose); }

 private:
  friend std::filesystem::path taps_file_to_come(const std::filesystem::path& directory);

  std::string directory_;  ///< with a slash at its end: joined as texts, which takes a tenth of joining paths
  bool packed_;
};

/// Where taps are appended to as soon as there are some: to be followed while it grows.
std::filesystem::path taps_file_to_come(const std::filesystem::path& directory);

/// Reads the lines of taps_file() in their order.
class TapLines {
 public:
  explicit TapLines(std::filesystem::path file) : lines_(std::move(file)) {}

  /// Returns the row of a tap or of its announcement; none for a line of another part. Throws Error, naming file and
  /// line, for a damaged one, and where taps do not count 1, 2, 3 ...: a line is missing, doubled or out of order.
  std::optional<Row> read(std::string_view line);

  const std::filesystem::path& file() const { return lines_.file(); }

 private:
  void check_order(const Row& row);

  RowLines lines_;
  std::int64_t taps_ = 0;   ///< whose results were read
  bool announced_ = false;  ///< the next one was announced
};

/// The same record held by this process, which adds to it.
class HeldFiles : public RunFiles {
 public:
  /// Makes the directory if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit HeldFiles(const std::filesystem::path& directory);

  /// Cuts off the half line that a kill left behind, and has a line of times, if only one without numbers, for each of
  /// the `taps`: where taps and times have a file each, a kill between the two left none.
  void mend(const std::vector<Row>& taps);

  /// Opens what taps are added to.
  void open();

  /// Throws Error where the directory is no longer the one that was opened: nothing more can be recorded.
  void check_in_place() const;

  /// Throws Error where another process may be writing there, as FileLock::check() says: before each write.
  void check_held() const { lock_.check(); }

  /// A tap that was made, with its times, or one that is announced. With `sync` it is on the disk on return.
  void add_tap(const Row& tap, const TapTimes* times, bool sync);

  /// Takes the place of the one before.
  void set_manifest(const Tree& manifest, bool sync);
  void set_objects(const std::vector<Row>& objects, bool sync);

  /// A line about an attempt at a job.
  void add_attempt(const Row& attempt);

  /// Has the file system take all that was added. Throws Error where it does not.
  void flush() const;

 private:
  AppendFile& log();

  std::filesystem::path directory_;
  FileLock lock_;
  std::optional<AppendFile> log_;      ///< record.jsonl or taps.jsonl
  std::optional<AppendFile> timings_;  ///< of the loose layout, as the next
  std::optional<AppendFile> attempts_;
};

}  // namespace palpate
