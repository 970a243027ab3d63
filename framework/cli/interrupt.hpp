// SPDX-License-Identifier: MIT
// Reactions to Ctrl-C, SIGTERM and SIGHUP. These signals end the program at once. The exception is a command that must
// first finish a tap of an arm or stop its jobs.
#pragma once

#include <atomic>

namespace palpate::cli {

/// Becomes true when a signal arrives after listen_for_interrupts(). The value is never reset.
extern std::atomic<bool> interrupted;

/// Makes signals set `interrupted` instead of ending the program. Call this function right before a loop that reads the
/// flag. A second Ctrl-C still ends the program.
void listen_for_interrupts();

/// If the environment variable PALPATE_PARENT is set, makes this program end with its parent, as after SIGTERM. The
/// variable contains the process id of the parent. Python sets it, so that a sweep that Python started ends if Python
/// is killed. Call this function first in main(), while the program has a single thread.
void follow_parent();
/// Sets PALPATE_PARENT again for the program that will replace this process, if follow_parent() found the variable.
void keep_parent();

/// Returns whether the parent process set PALPATE_PARENT. If so, the parent reads the progress of the sweep.
bool is_followed();

}  // namespace palpate::cli
