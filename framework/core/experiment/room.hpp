// SPDX-License-Identifier: MIT
// The memory that a run works in.
#pragma once

namespace palpate {

/// Has the C library hold at once what a run of the paper takes in memory (640 kB), for the thread that calls, and keep
/// what the run gives back. Otherwise it asks the system for a little time and again, returns some in between, and each
/// page is a fault: two in five of all page faults of such a run. A wish: where the system has none of this, nothing
/// comes of it. Once a process, before anything else.
void make_room();

}  // namespace palpate
