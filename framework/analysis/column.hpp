// SPDX-License-Identifier: MIT
// Columns of results.csv, the values of jobs in them, and the status of each value.
#pragma once

#include "record/fields.hpp"
#include "record/row.hpp"
#include "sweep/sweep.hpp"

#include <palpate/options.hpp>

#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

struct Column {
  std::string name;
  Unit unit = Unit::none;
  RecordField::Better better = RecordField::Better::neither;  ///< `neither` if the column is not a field of the summary

  std::string words() const;  ///< returns "RMSE over the scene" for axes; the column's name if the field has no label
  std::string better_words() const;  ///< returns "less is better", "more is better" or ""
};

/// Returns the column with this name; `summary.NAME` also names a result (see result_of()). Throws Error of the command
/// line, naming `option` ("--cost"), if there is no such column.
Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option);

/// The number in a cell. Flags count as 0 and 1; swept values are text and count if they are plain numbers.
struct CellNumber {
  std::optional<double> value;  ///< nullopt for an empty cell and for a number that is not finite
  bool is_text = false;         ///< whether the cell holds text that is not a number
};
CellNumber number_of(const Scalar* cell);

/// Returns a cell as conditions read it: in the format of a config, with its unit. Returns "" for a missing or infinite
/// value.
std::string written_in(const std::string& column, const Scalar& cell);

/// Status of a job's value in a comparison. A pair of jobs has the status of one of its two jobs, namely the one that
/// comes first in this list.
enum class ValueStatus {
  left_out,  ///< A condition leaves the job out. A condition on a value that the job lacks is false.
  without_partner,
  unfinished,
  failed,
  without_value,  ///< the job is done, but the column is null or not finite
  counted
};

struct JobValue {
  ValueStatus status = ValueStatus::counted;
  double value = 0.0;  ///< the value, if `status` is `counted`
};

/// Returns the value of a job from its row. The row is null for a job that has not ended. Throws Error of the command
/// line, naming `option`, if the column holds text.
JobValue value_of_job(const Row* row, const std::string& column, const std::string& option);

/// Numbers of jobs, or of pairs, by status. A job that a condition leaves out counts as left out, whether it failed or
/// not.
class StatusCounts {
 public:
  void add(ValueStatus status) { ++counts_.at(static_cast<std::size_t>(status)); }
  int of(ValueStatus status) const { return counts_.at(static_cast<std::size_t>(status)); }
  int all() const { return std::accumulate(counts_.begin(), counts_.end(), 0); }
  bool all_are(ValueStatus status) const { return of(status) == all(); }
  /// Returns "2 failed, 1 unfinished": those numbers of `statuses` that are not 0. `behind` follows each number.
  std::string words(const std::vector<ValueStatus>& statuses, const std::string& behind = "") const;

 private:
  std::array<int, 6> counts_{};
};

/// Returns whether the row's run ended without a failure.
bool is_done(const Row& row);

}  // namespace palpate
