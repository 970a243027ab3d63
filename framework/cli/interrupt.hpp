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

}  // namespace palpate::cli
