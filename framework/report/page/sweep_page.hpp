// SPDX-License-Identifier: MIT
// The page of a sweep: the state of every job, the results of finished jobs, means over settings, and Pareto fronts.
// web/sweep.js draws the data. The reader of the page chooses the keys of groups, so the page itself computes the means
// of groups.
#pragma once

#include "report/history.hpp"
#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// Largest number of jobs on a page. A job takes up to 700 bytes, and larger pages would be too slow in browsers and
/// too large to send.
inline constexpr std::size_t kMostJobsOnAPage = 20000;

/// Returns the page of a sweep, finished or not. The links to the pages of jobs work if the page is in the directory of
/// the sweep. If there are more than `most_jobs` jobs, the page has every second, third, ... job and a note about this.
/// `progress` receives numbers of jobs. Throws Error for a damaged record.
std::string sweep_page(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

/// Returns the headline fields: the main error, then the others in the order of the summary.
std::vector<std::string> headline_fields(const std::vector<Row>& results);

/// Returns the data of the page of sweep_page().
Json sweep_data(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

}  // namespace palpate
