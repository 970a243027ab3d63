// SPDX-License-Identifier: MIT
// The page of a sweep: the state of every job, the numbers of ended jobs, means over settings, and Pareto fronts.
// web/sweep.js draws the data. Its reader chooses keys of groups, so their means are formed there.
#pragma once

#include "report/history.hpp"
#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// Largest number of jobs on a page, for browsers and for files that are sent: a job takes up to 700 bytes.
inline constexpr std::size_t kMostJobsOnAPage = 20000;

/// Returns the page of a sweep, finished or not. Links to the pages of its jobs work if the page lies in the sweep's
/// directory. With more than `most_jobs` jobs, it has every second, third, ... job and a note. `progress` counts jobs.
/// Throws Error for a damaged record.
std::string sweep_page(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

/// Returns the headline fields: the main error, then the others in the order of the summary.
std::vector<std::string> headline_fields(const std::vector<Row>& results);

/// Returns the data of that page.
Json sweep_data(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

}  // namespace palpate
