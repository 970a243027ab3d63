// SPDX-License-Identifier: MIT
// The record of a run by its kinds of lines.
#pragma once

#include "record/row.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// The whole lines of a kind ("tap", "attempt", "manifest" ...) in the record of a run; "" where there is none.
std::string part_of(const std::filesystem::path& run, const std::string& kind);

/// The same as rows; not of kinds that hold lists.
std::vector<Row> rows_of(const std::filesystem::path& run, const std::string& kind);

/// The record of a run, whole lines, without what is not the same when it is made again: attempts, set-ups, times, end.
std::string lasting_part_of(const std::filesystem::path& run);

/// The first lines of a record up to its tap `taps`, its times included, as a kill then would have left it; 0 for what
/// is before the first.
std::string record_until(const std::string& record, int taps);

/// Makes a run that has ended one that was killed just before: its tables stay, its end and summary.json go.
void forget_end(const std::filesystem::path& run);

/// Gives a run, or a folder without a record, this end; `summary` is JSON with `status`: done or failed.
void set_end(const std::filesystem::path& run, const std::string& summary);

/// Puts the lines of `text` in the places of those of a kind; where there are fewer, the others go.
void write_part(const std::filesystem::path& run, const std::string& kind, const std::string& text);

/// The first lines of a record in which taps are made again: a manifest, an attempt and its set-up.
std::string begun_record(bool announces = false);

}  // namespace palpate::test
