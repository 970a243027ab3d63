// SPDX-License-Identifier: MIT
// What is measured for the summary of a run, and its surface; the fields of the summary are in fields.cpp.
#pragma once

#include "experiment/experiment.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

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

/// The most memory that this process has had.
std::int64_t peak_rss_bytes();

/// Returns the name and the content of the file of the reconstructed surface: surface.csv (a row per candidate:
/// position, mean and standard deviation of the height, object probability, reconstruction, truth), or for a mesh
/// surface.ply. In the stage `summary`.
std::pair<std::string, std::string> surface_file(Experiment& experiment);

/// Returns the true heights at fixed candidates, metres.
Eigen::VectorXd true_heights(const Candidates& candidates, const Scene& scene);

/// Returns the arrays that the readers of a run have now, as CSV; "" if there are none, or no fixed candidates.
std::string maps_csv(Belief& belief, const BeliefState& state);

}  // namespace palpate
