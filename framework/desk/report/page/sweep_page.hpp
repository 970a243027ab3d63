// SPDX-License-Identifier: MIT
// The report of a sweep as one page: what became of every job, and the numbers of those that ended, from which
// web/sweep.js draws what is asked for. Groups, means and the front are made there, so that they follow the choices
// of whoever reads.
#pragma once

#include "report/history.hpp"
#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>

namespace palpate {

/// More than these are too many for a browser, and for a file that is sent to others: up to 700 bytes a job.
inline constexpr std::size_t kMostJobsOnAPage = 20000;

/// The page of a sweep as it stands, under way or not: HTML, complete in itself but for the links to its jobs, which
/// hold where the page lies in the sweep's directory. Of more than `most_jobs` it has every second, third, ..., and
/// says so. `progress` counts jobs. Throws Error for a damaged record.
std::string sweep_page(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

/// What that page is drawn from.
Json sweep_data(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs = kMostJobsOnAPage);

}  // namespace palpate
