// SPDX-License-Identifier: MIT
// Measurements for the summary of a run, and the files of its surface and maps. The fields of the summary are in
// fields.cpp.
#pragma once

#include "experiment/experiment.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace palpate {

/// Measures the wall time and the CPU time of the current thread since the construction of the stopwatch.
class Stopwatch {
 public:
  Stopwatch();
  double wall_seconds() const;
  double cpu_seconds() const;

 private:
  std::chrono::steady_clock::time_point wall_;
  double cpu_;
};

/// Returns the peak memory of this process.
std::int64_t peak_rss_bytes();

/// Returns name and content of the file of the reconstructed surface; call this in the stage `summary`. A height map
/// gives surface.csv, with one row per candidate: position, mean and standard deviation of the height, object
/// probability, reconstruction, truth. A mesh gives surface.ply.
std::pair<std::string, std::string> surface_file(Experiment& experiment);

/// Returns the true heights at fixed candidates, in metres.
Eigen::VectorXd true_heights(const Candidates& candidates, const Scene& scene);

/// Returns the current arrays of the belief as CSV; "" if there are none, or if the candidates are not fixed.
std::string maps_csv(Belief& belief, const BeliefState& state);

}  // namespace palpate
