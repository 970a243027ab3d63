// SPDX-License-Identifier: MIT
// Work on many things that leave files and nothing else, shared among child processes: plugins need not bear threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace palpate {

/// Of this machine, at least 1.
int cores();

/// Calls `work` for every number below `count`, in up to `workers` processes forked from this one, which die with it.
/// `progress` (may be null) hears after each how many are done. Returns whether all are: false once `interrupted` (may
/// be null) is set. Throws Error, of kind `run`, with what the first of them could not do; the others are then ended.
bool in_children(std::size_t count, int workers, const std::function<void(std::size_t)>& work,
                 const std::atomic<bool>* interrupted, const std::function<void(std::size_t)>& progress);

}  // namespace palpate
