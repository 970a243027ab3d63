// SPDX-License-Identifier: MIT
// What is measured for the summary of a run, and its surface; the fields of the summary are in fields.cpp.
#pragma once

#include "space/from_any_side.hpp"

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

/// What the surface came to, as a file and its content: surface.csv (the candidate grid: x, y, height mean and standard
/// deviation, on-surface probability, reconstruction, truth), or, of a run from any side, surface.ply.
std::pair<std::string, std::string> surface_file(Experiment& experiment);

/// The maps of the models that are recorded, as CSV; "" if there are none.
std::string maps_csv(const FromAbove& experiment);

}  // namespace palpate
