// SPDX-License-Identifier: MIT
// What runs and sweeps come to at a glance, a line each: the table of `palpate list`. Of a run that has ended config
// and summary are read, and no tap: there may be hundreds.
#pragma once

#include "record/row.hpp"
#include "sweep/condition.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A run or a sweep as it is listed.
struct ListedRecord {
  /// `name`, `begun`, `strategy`, `scene`, of a run `taps`, errors and `state`; of a sweep `jobs` and how many are
  /// `jobs_done`, `jobs_failed` and `jobs_running`; `directory`. Null is what is not known.
  Row row;
  Row beside;  ///< what else a condition may name: fields of the summary, then keys of the config
};

/// Reads the one in `directory`. A strategy and a scene are called as the group is that a config named, else by what
/// they are made of: the type of the acquisition, the shapes of the objects. Throws Error for a damaged one.
ListedRecord list_record(const std::filesystem::path& directory);

/// The rows of those of which `where` holds. A name that only others have is null, as everywhere in conditions. Throws
/// Error for a name that none has.
std::vector<Row> rows_where(const std::vector<ListedRecord>& records, const Condition& where);

/// The rows under a header; "" if there are none.
std::string runs_table(const std::vector<Row>& rows);

}  // namespace palpate
