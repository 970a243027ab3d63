// SPDX-License-Identifier: MIT
// Columns of results.csv, the value of each job in a column, and the status of each value.
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

/// Returns the column `name`; `summary.NAME` also names a result (see result_of()). Throws Error with the place
/// "command line" if there is no such column; the message names `option`, such as "--cost".
Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option);

/// The number in a cell. Flags are converted to 0 and 1. Swept values are text, which is converted if it is a plain
/// number.
struct CellNumber {
  std::optional<double> value;  ///< nullopt for an empty cell and for a number that is not finite
  bool is_text = false;         ///< whether the cell holds text that is not a number
};
CellNumber number_of(const Scalar* cell);

/// Returns a cell in the format that conditions compare: as in a config, with its unit. Returns "" for a value that is
/// missing or not finite.
std::string written_in(const std::string& column, const Scalar& cell);

/// Status of a job's value in a comparison. A pair of jobs has the status of one of its jobs: the status that comes
/// first in this list.
enum class ValueStatus {
  left_out,  ///< The job does not satisfy the condition. A condition on a value that the job lacks is false.
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

/// Returns the value of a job from its row. The row is null for a job that has not ended. Throws Error with the place
/// "command line" if the column holds text; the message names `option`.
JobValue value_of_job(const Row* row, const std::string& column, const std::string& option);

/// Numbers of jobs, or of pairs, by status. A job that a condition leaves out counts as left out, even if it failed.
class StatusCounts {
 public:
  void add(ValueStatus status) { ++counts_.at(static_cast<std::size_t>(status)); }
  int of(ValueStatus status) const { return counts_.at(static_cast<std::size_t>(status)); }
  int all() const { return std::accumulate(counts_.begin(), counts_.end(), 0); }
  bool all_are(ValueStatus status) const { return of(status) == all(); }
  /// Returns the nonzero counts of `statuses`: "2 failed, 1 unfinished". Inserts the text `behind` after each number.
  std::string words(const std::vector<ValueStatus>& statuses, const std::string& behind = "") const;

 private:
  std::array<int, 6> counts_{};
};

/// Returns whether the row's run ended without a failure.
bool is_done(const Row& row);

}  // namespace palpate
