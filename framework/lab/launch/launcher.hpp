// SPDX-License-Identifier: MIT
// Who runs the jobs of a sweep, and where. A launcher takes jobs and lets go of them; whether a job is done it does not
// say, because schedulers err: that stands in the job's directory alone, and the job itself (launch/job.hpp) sees to it
// that nothing runs twice, however many launchers have it in hand.
#pragma once

#include <vector>

namespace palpate {

class Launcher {
 public:
  /// What poll() saw.
  struct State {
    std::vector<std::size_t> returned;  ///< jobs that it let go since the last call, in whatever state
    int running = 0;                    ///< jobs, as far as it knows
    int waiting = 0;                    ///< jobs
    bool empty_handed() const { return running == 0 && waiting == 0; }
  };

  virtual ~Launcher() = default;

  /// Takes these jobs (indices into Sweep::jobs, ascending, none of them in its hands) and returns without waiting for
  /// any. Throws Error when none can be taken.
  virtual void submit(const std::vector<std::size_t>& jobs) = 0;

  /// Waits until something happens, but not for more than `seconds`, nor beyond a signal, nor with empty hands. Throws
  /// Error when nothing can be known any more.
  virtual State poll(double seconds) = 0;

  /// Asks what runs to stop after the tap under way, and forgets what waits; what is running is still returned.
  virtual void cancel() = 0;
};

}  // namespace palpate
