// SPDX-License-Identifier: MIT
// What is written when a run has ended: its summary and its surface.
#pragma once

#include "experiment/experiment.hpp"
#include "experiment/resolved.hpp"
#include "record/row.hpp"

#include <array>
#include <chrono>
#include <string>

namespace palpate {

/// Wall time and CPU time of this thread since it was made.
class Stopwatch {
 public:
  Stopwatch();
  double wall_seconds() const;
  double cpu_seconds() const;

 private:
  std::chrono::steady_clock::time_point wall_;
  double cpu_;
};

/// The fields of summary.json in their order. `failure` is "" unless the run failed; `phases` are seconds by phase.
Row summary_row(const ResolvedConfig& config, const RunResult& result, const std::string& failure,
                const Stopwatch& watch, const std::array<double, kPhases>& phases);

/// Whether a field of the summary depends on clock, memory or machine rather than on the config.
bool depends_on_machine(const std::string& field);

/// The candidate grid: x, y, height mean and standard deviation, on-surface probability, reconstruction, truth.
std::string surface_csv(Experiment& experiment);

/// The maps of the models that are recorded, as CSV; "" if there are none.
std::string maps_csv(const Experiment& experiment);

}  // namespace palpate
