// SPDX-License-Identifier: MIT
// Ctrl-C, SIGTERM and SIGHUP. They end the program at once, unless a command must first finish a tap of an arm or stop
// its jobs.
#pragma once

#include <atomic>

namespace palpate::cli {

/// True after a signal that followed listen_for_interrupts(). The value is never reset.
extern std::atomic<bool> interrupted;

/// Makes signals set `interrupted` instead of ending the program. Call this function right before a loop that reads the
/// flag. A second Ctrl-C still ends the program.
void listen_for_interrupts();

/// Ends this program as SIGTERM does when its parent ends, if the environment variable PALPATE_PARENT is the process id
/// of the parent. So the sweep of a killed Python does not go on. Call this function first, with a single thread.
void follow_parent();
/// Sets PALPATE_PARENT again for the program that this process is about to execute.
void keep_parent();

/// Returns whether the parent set PALPATE_PARENT. Such a parent reads the progress of a sweep.
bool is_followed();

}  // namespace palpate::cli
