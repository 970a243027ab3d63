// SPDX-License-Identifier: MIT
// The record of a run, record.jsonl: all events in their order, one JSON object per line. The file only grows. The
// process that executes the run keeps the file locked. The last line records how the run ended. The first key of a line
// is its kind:
//
// | first key | line |
// |---|---|
// | manifest | program, build, config and plugins; the first line |
// | attempt | a process starts or resumes the run, before it builds the experiment |
// | setup | the experiment is built: whether taps are announced, and which parts of the run read each model |
// | intent | announces a tap that cannot be repeated, before it is made |
// | tap | a tap that was made, before the models process it |
// | timing | times of the phases of this tap |
// | objects | results for each object at the end |
// | note | any other observation about the run |
// | end | how the run, or this attempt, ended |
//
// Rules of the format (RecordReader checks rules 1 to 7):
//
// 1. The first line is a manifest. No other line is a manifest.
// 2. Attempts are numbered 1, 2, 3 ... and contain the number of taps so far. Setup n follows attempt n, before the
//    first intent or tap of this attempt.
// 3. Taps are numbered 1, 2, 3 ...
// 4. If taps are announced, exactly one intent k precedes tap k.
// 5. Timing k follows tap k.
// 6. No line follows an end `done`, which contains the number of taps. Only an attempt may follow any other end.
// 7. Only the last line may lack its newline. Such a line is ignored.
// 8. If summary.json exists but the record has no `end`, the record was cut (RunStatus::cut).
//
// Lines of other kinds and unknown fields are ignored. The fields are listed in runs/README.md.
#pragma once

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

/// Returns the kind of a line from its first key alone.
LineKind kind_of_line(std::string_view line);

/// The end of a run or of an attempt.
struct Ending {
  enum class EndKind { done, failed, interrupted };
  struct ListedFile {
    std::string name;  ///< without a folder
    std::uintmax_t bytes = 0;
    std::string hash;
  };

  EndKind how = EndKind::interrupted;
  std::string reason;             ///< reason of the end
  Row summary;                    ///< empty for an interrupted run
  std::vector<ListedFile> files;  ///< files next to the record that were made from it
};
const char* ending_name(Ending::EndKind how);

struct RecordLine {
  LineKind kind = LineKind::other;
  Row row;                    ///< content of attempt, intent, tap, timing, note and end
  Tree tree;                  ///< content of the other kinds, which contain lists
  std::optional<Ending> end;  ///< parsed content of an `end`
};

/// Returns the times in a line `timing`.
TapTimes times_of(const Row& timing);

/// Reads the lines of a record one by one, in their order.
class RecordReader {
 public:
  explicit RecordReader(std::filesystem::path file) : lines_(std::move(file)) {}

  /// Parses `line`, which has no line end. Throws Error, with file and line, if the line is not an object, is too long
  /// or violates a rule of the format (see the beginning of this file).
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

  JsonLinesReader lines_;
  bool begun_ = false;  ///< whether the manifest was read
  std::int64_t attempts_ = 0;
  bool set_up_ = false;     ///< whether the last attempt has its setup
  bool announces_ = false;  ///< whether the taps of this attempt are announced
  std::int64_t taps_ = 0;   ///< number of taps with a result
  bool announced_ = false;  ///< whether the next tap was announced
  LineKind last_ = LineKind::other;
  std::optional<Ending::EndKind> end_;  ///< nullopt unless the last line is an `end`
};

/// Content of a record.
struct RunRecord {
  std::filesystem::path file;
  std::optional<Tree> manifest;   ///< nullopt if the record is empty
  std::vector<Row> attempts;      ///< attempts that ended have the field `end`
  std::optional<Tree> setup;      ///< setup of the last attempt
  std::vector<Row> taps;          ///< one row per tap
  std::optional<Row> intent;      ///< announced tap without a result
  std::vector<TapTimes> timings;  ///< times of the taps; a kill may have lost some
  std::vector<Row> objects, notes;
  std::optional<Ending> end;  ///< nullopt unless the last line is an `end`

  /// Returns the hash of the build that started the run; "" if it is not known.
  std::string build() const;
  /// Returns whether the record contains only the failure of a run that could not begin.
  bool is_failure_alone() const { return manifest && manifest->find("build") == nullptr && attempts.empty(); }
};

/// Returns the record in `directory`; an empty one if there is none. Throws Error as RecordReader does.
RunRecord read_run_record(const std::filesystem::path& directory);

/// Returns the manifest and reads no other line; nullopt if there is none. Throws Error.
std::optional<Tree> read_manifest(const std::filesystem::path& directory);

/// State of a run according to the last complete line of its record.
struct RecordEnd {
  bool begun = false;         ///< whether the record has a line
  std::optional<Ending> end;  ///< nullopt for a run that is running or was killed
};

/// Reads only the last complete line of a record. Throws Error if this line is damaged.
RecordEnd read_record_end(const std::filesystem::path& directory);

/// Returns the number of attempts in the last series of attempts without an `end` between them. For example, the result
/// is 2 for attempt, end, attempt, attempt. Does not check the lines. Throws Error if the file system fails.
int attempts_in_row(const std::filesystem::path& directory);

/// Returns the times of the taps as a table.
std::vector<Row> timing_rows(const std::vector<TapTimes>& timings);

}  // namespace palpate
