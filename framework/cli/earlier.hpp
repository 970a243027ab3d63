// SPDX-License-Identifier: MIT
// The jobs of a sweep as they were after fewer taps, computed where nobody asked before.
#pragma once

#include "cli/commands.hpp"
#include "sweep/sweep.hpp"

#include <optional>
#include <vector>

namespace palpate::cli {

/// For each of `taps` the rows of results.csv as they would be, had all jobs stopped there. What is missing is computed
/// by `workers` processes, or as many as there are cores, with a line of progress on stderr. None if that was
/// interrupted: what is done then is kept. Throws Error.
std::optional<std::vector<std::vector<Row>>> results_at(const Program& program, const Sweep& sweep,
                                                        const std::vector<int>& taps, std::optional<int> workers);

}  // namespace palpate::cli
