// SPDX-License-Identifier: MIT
// Combines several sweeps and runs of different plans into one sweep, for comparisons, curves and Pareto fronts.
#pragma once

#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// The jobs of several records as one sweep, which exists only in memory.
struct PooledSweep {
  Sweep sweep;
  std::vector<std::string> notes;  ///< notes for the reader of the results, one line each
};

/// Reads sweeps and runs as one sweep, in the order of `records`. If `records` is a single sweep, the result is that of
/// read_sweep().
///
/// The keys are all swept keys, `by`, the seed, and each further option in which the recorded configs differ. If the
/// types of a plugin differ, the key is the plugin's block (`acquisition`), else the option (`kernel.length_scale`).
/// Some options are keys only if `by` contains them. If the strategy is swept, these are the options with one value per
/// strategy. If `by` contains `name`, these are the options with one value per name, except for scenes. Options that do
/// not affect results, such as `log`, are not keys.
///
/// The value of a key that a record does not sweep comes from the configs of its jobs. Values are equal if the configs
/// have equal content, for example `2 cm` and `0.02 m`, or `scene=ring` and a config with the same objects. If sweeps
/// write the same value differently, the text of the first sweep is used. If two different values have the same text,
/// the name of the record is appended to the later one. A record that does not sweep `strategy` has its own name as the
/// value of this key.
///
/// If several records contain the same run, it counts as one job: the first of its jobs that has ended. If `by`
/// contains `name`, the run counts as one job per record. The directory of the sweep is the common folder of the
/// records. Throws Error for an empty list, for a directory without a run or sweep, and for a damaged record. Runs with
/// the same id but different taps are an error, too.
PooledSweep read_pooled(const std::vector<std::filesystem::path>& records, const std::vector<std::string>& by);

/// Returns the innermost folder that contains all of these directories.
std::filesystem::path common_folder(const std::vector<std::filesystem::path>& directories);

}  // namespace palpate
