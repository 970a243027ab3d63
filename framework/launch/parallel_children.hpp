// SPDX-License-Identifier: MIT
// Distributes work among child processes. The work may return results only as files. Child processes are used instead
// of threads, because plugins need not be thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace palpate {

/// Returns the number of cores of this machine, at least 1.
int cores();

/// Calls `work` for each number below `count`, in up to `workers` forked child processes, which end with this process.
/// Calls `progress` (may be null) with the number of finished items. Returns false if `interrupted` (may be null) was
/// set first. If a child fails, ends the other children and throws Error of kind `run` with the message of the first
/// child that failed.
bool in_children(std::size_t count, int workers, const std::function<void(std::size_t)>& work,
                 const std::atomic<bool>* interrupted, const std::function<void(std::size_t)>& progress);

}  // namespace palpate
