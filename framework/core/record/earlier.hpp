// SPDX-License-Identifier: MIT
// What a finished run had come to after fewer taps: its summary, had the budget been smaller, from the recorded taps.
#pragma once

#include "record/recording.hpp"
#include "record/row.hpp"

#include <vector>

namespace palpate {

/// The summary of `recording`, which ended well, after each of these numbers of taps, which ascend and are less than
/// it made. Equal to that of a run whose budget they are, in all that depends on the config alone: choosing a tap looks
/// at no budget, and reading a model changes none. Only the engines are those that `posterior: auto` took for the run's
/// own budget; where it would take another for less, numbers may differ as far as `accuracy` lets them.
///
/// Of the rest the record knows this much: `compute.*` are the sums of timings.csv so far; `wall_seconds` and
/// `compute_seconds` the share of the run's own that these sums have in those of all taps; the memory, which nobody
/// measured then, is null. The id is that of the run. Throws Error for a damaged record.
std::vector<Row> summaries_after(const Workshop& workshop, const Recording& recording, const std::vector<int>& taps);

}  // namespace palpate
