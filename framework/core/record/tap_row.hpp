// SPDX-License-Identifier: MIT
// Taps as rows of taps.jsonl and taps.csv, before and after they are made, and back; their fields are in fields.cpp.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/row.hpp"

#include <optional>
#include <string>

namespace palpate {

/// A tap after it was made.
Row tap_row(const TapRecord& tap);

/// The same before it is made: marked as an intent, without what only the tap can tell.
Row intent_row(const TapRecord& tap);

/// Whether a row of taps.jsonl announces a tap instead of telling its result.
bool is_intent(const Row& row);

/// An intent as the result of a tap that nobody saw the end of.
Row unknown_result_of(const Row& intent);

/// What a resumed run must know of a recorded tap. Throws Error, naming `where`, for a row that is not a tap.
PastTap past_tap(const Row& row, const std::string& where);

const char* outcome_name(Outcome outcome);
const char* source_name(Source source);

}  // namespace palpate
