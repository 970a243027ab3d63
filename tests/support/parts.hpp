// SPDX-License-Identifier: MIT
// The record of a job of a sweep, record.jsonl, by the files that runs of their own have, and older sweeps' jobs.
#pragma once

#include "record/row.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// What that file ("taps.jsonl", "attempts.jsonl", "manifest.json", "timings.csv", "objects.csv") would hold of a run's
/// or a job's complete lines; the file itself where it is there, and "" where there is nothing of it.
std::string part_of(const std::filesystem::path& run, const std::string& name);

/// The lines of such a file of JSON as rows.
std::vector<Row> rows_of(const std::filesystem::path& run, const std::string& name);

/// Gives a job the files that an older palpate would have left.
void unpack(const std::filesystem::path& job);

}  // namespace palpate::test
