// SPDX-License-Identifier: MIT
// Parallel reading of job directories. The file system of a cluster has a high latency, so sequential reading would
// mostly wait.
#pragma once

#include "gp/workers.hpp"
#include "sweep/sweep.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <type_traits>
#include <utility>
#include <vector>

namespace palpate {

/// Calls `use(job, read(directory))` for each of `jobs` (indices into Sweep::jobs), in their order and in the calling
/// thread. `read` runs in several threads. Rethrows the first exception of `read` or `use`, in the order of the jobs.
template <class Read, class Use>
void read_jobs(const Sweep& sweep, const std::vector<std::size_t>& jobs, const Read& read, const Use& use) {
  constexpr std::size_t kMostThreads = 8;
  constexpr std::size_t kJobsPerThread = 32;  // for fewer jobs, a thread costs more than it saves
  constexpr std::size_t kBlock = 256;         // limits the number of results held in memory
  Workers workers(static_cast<int>(std::clamp<std::size_t>(jobs.size() / kJobsPerThread, 1, kMostThreads)));
  for (std::size_t begin = 0; begin < jobs.size(); begin += kBlock) {
    std::vector<std::invoke_result_t<Read, std::filesystem::path>> block(std::min(kBlock, jobs.size() - begin));
    std::vector<std::exception_ptr> thrown(block.size());
    workers.for_each(static_cast<int>(block.size()), [&](int piece, int) {
      const auto at = static_cast<std::size_t>(piece);
      try {
        block[at] = read(job_directory(sweep, sweep.jobs[jobs[begin + at]]));
      } catch (...) {  // rethrown below, in the order of the jobs
        thrown[at] = std::current_exception();
      }
    });
    for (std::size_t at = 0; at < block.size(); ++at) {
      if (thrown[at]) std::rethrow_exception(thrown[at]);
      use(jobs[begin + at], std::move(block[at]));
    }
  }
}

}  // namespace palpate
