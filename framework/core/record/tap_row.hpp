// SPDX-License-Identifier: MIT
// Taps as lines of record.jsonl and rows of taps.csv, before and after they are made, and back; their fields are in
// fields.cpp.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A tap after it was made.
Row tap_row(const TapRecord& tap);

/// The same before it is made: its first field is `intent`, and what only the tap can tell is null or left out.
Row intent_row(const TapRecord& tap);

/// Returns whether the contact of a row is one with an object as `counts` has it, which may read it otherwise than the
/// row does; none where the tap made no contact.
std::optional<bool> label_now(const Row& row, const RunResult& counts);

/// An intent as the result of a tap that nobody saw the end of.
Row unknown_result_of(const Row& intent);

/// What a resumed run must know of recorded taps. Throws Error, naming `file` and the tap, for a row that is none.
std::vector<PastTap> past_taps(const std::vector<Row>& rows, const std::filesystem::path& file);

const char* outcome_name(Outcome outcome);
const char* source_name(Source source);

}  // namespace palpate
