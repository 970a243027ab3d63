// SPDX-License-Identifier: MIT
// The workloads of the posterior: recorded taps, replayed as an experiment would meet them.
#pragma once

#include "support/gaussian_process.hpp"

#include <filesystem>
#include <vector>

namespace palpate::benchmark {

/// Taps with their answers, in the units of the file: centimetres for places, decimetres for heights.
struct Taps {
  Points places;
  Eigen::MatrixXd answers;  ///< height and label, a tap a row
};

/// Columns x, y, height, on_object under a header. Throws Error.
Taps read_taps(const std::filesystem::path& file);

/// A square of 23 cm with `count` candidates a side, corners included.
CandidateGrid square(int count);

/// The kernel of the workloads, a squared exponential of 3 cm.
std::shared_ptr<Kernel> make_kernel();

/// What was chosen after every tap but the initial ones, and how long that took.
struct Replay {
  std::vector<int> choices;     ///< candidates
  std::vector<double> seconds;  ///< of bringing the maps up to date and choosing, a choice; the first also pays for
                                ///< the initial taps
  double total = 0.0;           ///< seconds, the making of the process included
};

constexpr int kInitialTaps = 3;

/// Brings the taps one by one to a height and a label GP of unit variance and noise variance 1e-4, and chooses
/// the best of u w after each, the initial ones apart.
Replay replay(const Taps& taps, const CandidateGrid& candidates, const std::shared_ptr<Kernel>& kernel,
              const EngineSettings& settings, std::unique_ptr<test::GaussianProcess>* last = nullptr);

}  // namespace palpate::benchmark
