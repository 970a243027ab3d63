// SPDX-License-Identifier: MIT
// Ctrl-C and SIGTERM. They end the program at once, as nobody is surprised by, until a command begins what has to come
// to an end of its own: a tap that an arm is making, jobs that must be told.
#pragma once

#include <atomic>

namespace palpate::cli {

/// Set by a signal once listen_for_interrupts() was called, and never reset.
extern std::atomic<bool> interrupted;

/// From here on a signal only asks, by `interrupted`: call it right before what looks at that again and again. A second
/// Ctrl-C ends the program all the same.
void listen_for_interrupts();

/// Ends the program, as SIGTERM does, when the process that began it ends, if that asks for it by PALPATE_PARENT, its
/// process id. So the sweep of a Python that is killed does not go on. Call it first, from the only thread.
void follow_parent();
/// Asks the same of the program that this process is about to become.
void keep_parent();

/// Whether such a process reads how far a sweep has come, as people do on a terminal.
bool is_followed();

}  // namespace palpate::cli
