// SPDX-License-Identifier: MIT
// Repeats the runs of a bundle and compares their records.
#pragma once

#include "bundle/bundle.hpp"
#include "record/run.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// Result of checking a run.
struct RunCheck {
  enum class Kind {
    repeated,   ///< a simulated run was run again
    replayed,   ///< the models were computed again from the recorded taps, because the taps cannot be made again
    unchecked,  ///< a plugin is missing, or the run cannot be read
  };
  Kind kind = Kind::unchecked;
  std::string reason;                    ///< why a run was not repeated; "" if it was
  std::vector<std::string> differences;  ///< one line per difference
  /// whether program, plugins and instruction set are those that made the run; then all numbers must be equal
  bool same_build = false;
};

/// Largest relative difference between numbers that two builds compute. Places and outcomes of taps must be equal.
inline constexpr double kNumberTolerance = 1e-6;

/// Returns whether two texts differ: the numbers in them by more than kNumberTolerance, or the other parts at all.
bool differ(const std::string& recorded, const std::string& now);

/// Checks a run of the bundle, whose folder is `run`, against its config. Makes the taps of a simulated run again, in
/// the folder `scratch`; replays other runs. `runs_programs`: whether programs that the config names may be started.
/// Does not throw Error: an error is a difference.
RunCheck check_run(const RunEnvironment& environment, const UnpackedBundle& bundle, const std::string& run,
                   const std::filesystem::path& scratch, bool runs_programs);

/// Runs of a bundle, and what is wrong with the files around them.
struct BundleContent {
  std::vector<std::string> runs;  ///< folders of all runs, relative to the bundle
  std::vector<std::string> differences;
};

/// Lists the runs of an unpacked bundle, and checks that every file is what the bundle would contain: jobs of sweeps,
/// files that configs name. Content of runs, sources and results is not checked.
BundleContent check_content(const UnpackedBundle& bundle, const BundleIndex& index);

}  // namespace palpate
