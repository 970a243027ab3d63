// SPDX-License-Identifier: MIT
// A column of results.csv about which something is to be said, and what stands in it.
#pragma once

#include "record/fields.hpp"
#include "record/row.hpp"

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

struct Column {
  std::string name;
  Unit unit = Unit::none;
  RecordField::Better better = RecordField::Better::neither;  ///< `neither` of what is no field of the summary
};

/// The names of all columns that `results` have.
std::vector<std::string> columns_of(const std::vector<Row>& results);

/// The column that `option` ("--cost") names. Throws Error, of the command line, if there is none.
Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option);

/// The number in a cell; flags are 0 and 1, and swept values, which are text, count if they are plain numbers. None
/// where the row has no value. Throws Error, of the command line, for other text.
std::optional<double> number_in(const Row& row, const std::string& column, const std::string& option);

/// Whether the row is that of a run that ended well.
bool is_done(const Row& row);

}  // namespace palpate
