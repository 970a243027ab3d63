// SPDX-License-Identifier: MIT
// Several sweeps and runs, made of different plans, as one sweep: comparisons, curves and fronts take it as any other.
#pragma once

#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// The jobs of several records. Nothing of it stands in a file.
struct PooledSweep {
  Sweep sweep;
  std::vector<std::string> notes;  ///< one line each, for whoever reads the numbers
};

/// Reads sweeps and runs as one sweep, in the order of `records`; one sweep alone is what read_sweep() returns.
///
/// Keys are all that the sweeps vary, `by`, the seed, and every other option in which the recorded configs differ: the
/// name of a plugin's block (`acquisition`) where its type differs, else the option (`kernel.length_scale`). What
/// belongs to a strategy, if one is swept, or to a name, if `by` has `name`, is no key of its own unless `by` has it:
/// options that have one value for each of these, but for the scene. `log` and what else decides nothing is no key.
///
/// The value of a key that a record does not sweep is read from the config of its jobs. Values are the same where the
/// configs are: `2 cm` and `0.02 m`, `scene=ring` and a config that has the objects of it. They are written as the
/// first sweep that sweeps them has them, and a value of the same name that is another has the name of its record
/// behind it. `strategy`, which no recorded config has, is the name of the record there.
///
/// A run that stands in several records is one job, the first of them that has ended; where `by` has `name`, one job of
/// each record. The directory is the folder that has all records. Throws Error for no record, for what is neither a run
/// nor a sweep, or damaged, and for runs with the same id and other taps.
PooledSweep read_pooled(const std::vector<std::filesystem::path>& records, const std::vector<std::string>& by);

/// Returns the folder that has all of these directories.
std::filesystem::path common_folder(const std::vector<std::filesystem::path>& directories);

}  // namespace palpate
