// SPDX-License-Identifier: MIT
// The record of a run, record.jsonl: all that happened, a JSON object a line, in its order. It only grows. Who runs the
// run holds it locked, and its last line says how the run ended. The first key of a line says what it is:
//
// | first key | line |
// |---|---|
// | manifest | program, build, config and plugins; the first line |
// | attempt | a process begins or carries on the run, before it builds the experiment |
// | setup | the same, once it is built: whether taps are announced, who reads which model |
// | intent | a tap that cannot be repeated, before it is made |
// | tap | a tap that was made, before any model takes it in |
// | timing | how long that took |
// | objects | what is known of each object, at the end |
// | note | what else was found out |
// | end | how the run, or this attempt at it, ended |
//
// Laws, all of which RecordReader checks but the last:
//
// 1. the first line is a manifest, and no other is;
// 2. attempts count 1, 2, 3 ... and say how many taps there are; setup n follows attempt n, before an intent or a tap;
// 3. taps count 1, 2, 3 ...;
// 4. where they are announced, intent k stands before tap k, once;
// 5. timing k follows tap k;
// 6. behind an end that says done stands nothing, and it says how many taps there are; behind another only an attempt;
// 7. only the last line may lack its line end; it is then no line;
// 8. summary.json without an end means that the record was cut: RunStatus::cut.
//
// Lines of other kinds and fields of other names are passed over. runs/README.md has the fields.
#pragma once

#include "config/compose.hpp"
#include "config/tree.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/row.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

inline constexpr const char* kRecordFile = "record.jsonl";
inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kTapsTable = "taps.csv";

enum class LineKind { manifest, attempt, setup, intent, tap, timing, objects, note, end, other };

/// Returns what a line is by its first key alone.
LineKind kind_of_line(std::string_view line);

/// How a run ended, or an attempt at it.
struct Ending {
  enum class How { done, failed, interrupted };
  struct File {
    std::string name;  ///< without a folder
    std::uintmax_t bytes = 0;
    std::string hash;
  };

  How how = How::interrupted;
  std::string reason;       ///< why it stopped
  Row summary;              ///< empty of an interrupted run
  std::vector<File> files;  ///< beside the record, which were made from it
};
const char* ending_name(Ending::How how);

struct RecordLine {
  LineKind kind = LineKind::other;
  Row row;                    ///< of attempt, intent, tap, timing, note and end
  Tree tree;                  ///< of the others, which hold lists
  std::optional<Ending> end;  ///< of end, too
};

/// The times in a line `timing`.
TapTimes times_of(const Row& timing);

/// Reads the lines of a record one by one, in their order.
class RecordReader {
 public:
  explicit RecordReader(std::filesystem::path file) : lines_(std::move(file)) {}

  /// Returns a line, given without its end. Throws Error, naming file and line, for one that is no object or too long,
  /// and for one that breaks a law.
  RecordLine read(std::string_view line);

  const std::filesystem::path& file() const { return lines_.file(); }

 private:
  [[noreturn]] void refuse(const std::string& reason) const;
  void check(const RecordLine& line);
  void check_version(const Tree& manifest) const;
  void check_attempt(const Row& row);
  void check_setup(const Tree& line);
  void check_tap(const Row& row, bool announces);
  void check_timing(const Row& row) const;
  void check_end(const RecordLine& line);

  RowLines lines_;
  bool begun_ = false;  ///< the manifest was read
  std::int64_t attempts_ = 0;
  bool set_up_ = false;     ///< the last attempt is
  bool announces_ = false;  ///< its taps are announced
  std::int64_t taps_ = 0;   ///< whose results were read
  bool announced_ = false;  ///< the next one was announced
  LineKind last_ = LineKind::other;
  std::optional<Ending::How> end_;  ///< of the last line
};

/// All that a record holds.
struct RunRecord {
  std::filesystem::path file;
  std::optional<Tree> manifest;   ///< none where nothing is recorded
  std::vector<Row> attempts;      ///< with `end`, how it ended, of those that came to an end
  std::optional<Tree> setup;      ///< the last one
  std::vector<Row> taps;          ///< a row each
  std::optional<Row> intent;      ///< of a tap whose result is not there
  std::vector<TapTimes> timings;  ///< a kill may have lost some
  std::vector<Row> objects, notes;
  std::optional<Ending> end;  ///< of the last line

  /// The build that began it, "" if that is not known.
  std::string build() const;
  /// Whether it tells alone that the run failed before it could begin.
  bool is_failure_alone() const { return manifest && manifest->find("build") == nullptr && attempts.empty(); }
};

/// Reads the record in a directory; an empty one where there is none. Throws Error as RecordReader does.
RunRecord read_run_record(const std::filesystem::path& directory);

/// The manifest alone, without looking at what is behind it; none where there is none. Throws Error.
std::optional<Tree> read_manifest(const std::filesystem::path& directory);

/// What the last whole line of a record says, without reading what is before it.
struct RecordEnd {
  bool begun = false;         ///< there is a line
  std::optional<Ending> end;  ///< none of a run that is under way or was broken off
};

/// Throws Error for a damaged line.
RecordEnd read_record_end(const std::filesystem::path& directory);

/// How many attempts were made since one came to an end, the last ones; a damaged line counts, too. Throws Error where
/// the file system fails.
int attempts_in_row(const std::filesystem::path& directory);

/// The times of the taps as a table.
std::vector<Row> timing_rows(const std::vector<TapTimes>& timings);

}  // namespace palpate
