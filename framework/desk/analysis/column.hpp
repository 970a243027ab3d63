// SPDX-License-Identifier: MIT
// A column of results.csv about which something is to be said, and what stands in it.
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
  RecordField::Better better = RecordField::Better::neither;  ///< `neither` of what is no field of the summary

  std::string words() const;         ///< "RMSE over the scene", for axes; the name where the field has no words
  std::string better_words() const;  ///< "less is better", "more is better" or ""
};

/// The column that `option` ("--cost") names; that of a result is also `summary.NAME`: see result_of(). Throws Error,
/// of the command line, if there is none.
Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option);

/// The number in a cell; flags are 0 and 1, and swept values, which are text, count if they are plain numbers.
struct CellNumber {
  std::optional<double> value;  ///< none where there is nothing, or what is not finite
  bool is_text = false;         ///< other text stands there
};
CellNumber number_of(const Scalar* cell);

/// What a condition sees in a column: as it would be written in a config, with its unit, as it knows no other lengths;
/// "" of what is missing or not finite.
std::string written_in(const std::string& column, const Scalar& cell);

/// What became of a job of which a column is asked. Where a pair of jobs is, it has the status that stands first.
enum class ValueStatus {
  left_out,  ///< by a condition, which fails where it asks for what a job has not
  without_partner,
  unfinished,
  failed,
  without_value,  ///< done, but the column is null or not finite
  counted
};

struct JobValue {
  ValueStatus status = ValueStatus::counted;
  double value = 0.0;  ///< if it counts
};

/// The value of a job by its row, null for one that has not ended. Throws Error, of the command
/// line, where `option` names a column that holds other text.
JobValue value_of_job(const Row* row, const std::string& column, const std::string& option);

/// Some jobs, or pairs of them, by what became of each. What is left out counts as that alone, however it ended.
class StatusCounts {
 public:
  void add(ValueStatus status) { ++counts_.at(static_cast<std::size_t>(status)); }
  int of(ValueStatus status) const { return counts_.at(static_cast<std::size_t>(status)); }
  int all() const { return std::accumulate(counts_.begin(), counts_.end(), 0); }
  bool all_are(ValueStatus status) const { return of(status) == all(); }
  /// "2 failed, 1 unfinished": of `statuses` those that there are, with `behind` behind each number.
  std::string words(const std::vector<ValueStatus>& statuses, const std::string& behind = "") const;

 private:
  std::array<int, 6> counts_{};
};

/// Whether the row is that of a run that ended well.
bool is_done(const Row& row);

}  // namespace palpate
