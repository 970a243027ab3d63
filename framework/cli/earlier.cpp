// SPDX-License-Identifier: MIT
#include "cli/earlier.hpp"

#include "cli/interrupt.hpp"
#include "cli/sweep_display.hpp"
#include "launch/children.hpp"
#include "sweep/earlier_results.hpp"

#include <algorithm>
#include <thread>

namespace palpate::cli {

std::optional<std::vector<std::vector<Row>>> results_at(const Program& program, const Sweep& sweep,
                                                        const std::vector<int>& taps, std::optional<int> workers) {
  const EarlierResults earlier(sweep, taps);
  const std::vector<std::size_t>& missing = earlier.missing();
  const int together = workers.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  SweepLine line(false);
  SweepProgress progress;
  progress.jobs = static_cast<int>(missing.size());
  const auto show = [&](std::size_t done) {
    progress.done = static_cast<int>(done);
    progress.running = std::min(together, progress.jobs - progress.done);
    progress.last = done == missing.size();
    line.show(progress);
  };
  listen_for_interrupts();
  const bool all = in_children(
      missing.size(), together, [&](std::size_t i) { earlier.compute(program.workshop, missing[i]); },
      program.workshop.interrupted, show);
  if (!all) return std::nullopt;
  std::vector<std::vector<Row>> out;
  for (const int count : taps) out.push_back(earlier.write(count));
  return out;
}

}  // namespace palpate::cli
