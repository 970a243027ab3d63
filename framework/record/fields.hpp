// SPDX-License-Identifier: MIT
// The records of a run (tap, times of a tap, summary) and their fields. To add a field, add it to the list in
// fields.cpp. Files, `expect:`, `--where`, `--metric`, `palpate pareto`, pages and the tables of runs/README.md use
// that list.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/field.hpp"
#include "record/resolved_config.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Content of summary.json. Times and memory are nullopt if they were not measured.
struct Summary : RunResult {
  const ResolvedConfig& config;
  std::string failure;  ///< "" unless the run failed
  std::optional<double> wall_seconds, compute_seconds;
  std::optional<std::array<double, kPhases>> phases;  ///< seconds, all taps
  std::optional<std::int64_t> peak_rss_bytes;
};

/// Name of the field with the expected RMSE according to the final models of a run.
inline constexpr const char* kExpectedError = "expected_rmse_m";

/// Wall time of one tap in each phase, as in its line `timing`.
struct TapTimes {
  int tap = 0;
  std::array<double, kPhases> seconds{};
  std::optional<double> expected_rmse = std::nullopt;  ///< metres, before the tap; only if a display showed it
};

/// One object in the line `objects`.
struct ObjectRow : ObjectResult {
  int object = 0;
  std::string type;
};

const FieldList<TapRecord>& tap_list();
const FieldList<Summary>& summary_list();
const FieldList<TapTimes>& timing_list();
const FieldList<ObjectRow>& object_list();

/// Returns one row per object of the scene; no rows if the truth is not known.
std::vector<Row> object_rows(const Summary& summary);

/// Returns the fields that every summary has, in their order. The fields of the models depend on the config and are
/// left out.
const std::vector<RecordField>& summary_fields();

/// Returns the field of the summary with this name; null if there is none.
const RecordField* find_summary_field(const std::string& name);

/// Returns the dimension of a column of results.csv. The list of fields defines it for fields of the summary. For other
/// columns, the end of the name defines it: `_m` or `_seconds`.
Unit unit_of_column(const std::string& name);

/// Returns whether a field of the summary depends on time, memory or machine and not only on the config.
bool depends_on_machine(const std::string& name);

/// Returns whether a field of a tap or of the summary has a value only if the truth is known.
bool needs_truth(const std::string& name);

// Taps as lines of record.jsonl and rows of taps.csv.

/// Returns the row of a tap that was made.
Row tap_row(const TapRecord& tap);
/// Returns the row of a tap before it is made: its first field is `intent`, and its result is null or left out.
Row intent_row(const TapRecord& tap);
/// Converts the row of an announced tap (`intent`) to the row of a tap with an unknown result.
Row unknown_result_of(const Row& intent);
/// Returns the taps in recorded rows. The taps contain the data that a resumed run needs, without the models' states
/// and the errors. Throws Error, naming `file` and the tap, for a damaged row.
std::vector<TapRecord> read_taps(const std::vector<Row>& rows, const std::filesystem::path& file);
/// Returns whether, according to the labels in `counts`, the contact of a row is on an object; nullopt without a
/// contact.
std::optional<bool> label_now(const Row& row, const RunResult& counts);

const char* outcome_name(Outcome outcome);
const char* source_name(Source source);

/// Returns the fields for the error of the surface, the best-known measure first. Taps and summaries share these
/// fields.
const std::vector<RecordField>& error_fields();

/// Returns the contacts whose final label differs from the label recorded at their tap, from the field `relabelled` of
/// a summary.
std::vector<RelabelledContact> relabelled_in(const Row& summary);

/// Returns the field with the root mean square error of whole reconstructions: `rmse_m`, or `rms_surface_distance_m` if
/// the summaries have only the latter (taps from any side).
std::string main_error(const std::vector<Row>& summaries);

/// Adds the errors to a row; they are null if the truth is not known. errors_in() reads them from a row.
void add_errors(Row& row, const Errors& errors);
Errors errors_in(const Row& row);

}  // namespace palpate
