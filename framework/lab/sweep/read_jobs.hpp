// SPDX-License-Identifier: MIT
// Reads the directories of many jobs, several at once: a file system of a cluster answers late, and each answer would
// be waited for.
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

/// For each of `jobs`, indices into Sweep::jobs, hands `use(job, read(directory))` what `read` returned, in their
/// order and in the calling thread. `read` is called in several threads at once and gets the job's directory. What
/// either throws first, in the order of the jobs, is thrown here.
template <class Read, class Use>
void read_jobs(const Sweep& sweep, const std::vector<std::size_t>& jobs, const Read& read, const Use& use) {
  constexpr std::size_t kMostThreads = 8;
  constexpr std::size_t kJobsPerThread = 32;  // below that a thread costs more than it saves
  constexpr std::size_t kBlock = 256;         // what is read waits for its turn: not all of it at once
  Workers workers(static_cast<int>(std::clamp<std::size_t>(jobs.size() / kJobsPerThread, 1, kMostThreads)));
  for (std::size_t begin = 0; begin < jobs.size(); begin += kBlock) {
    std::vector<std::invoke_result_t<Read, std::filesystem::path>> block(std::min(kBlock, jobs.size() - begin));
    std::vector<std::exception_ptr> thrown(block.size());
    workers.for_each(static_cast<int>(block.size()), [&](int piece, int) {
      const auto at = static_cast<std::size_t>(piece);
      try {
        block[at] = read(job_directory(sweep, sweep.jobs[jobs[begin + at]]));
      } catch (...) {  // thrown on when its turn comes
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
