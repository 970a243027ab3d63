// SPDX-License-Identifier: MIT
// The settings of pooled records (pooled_sweep.hpp): the keys in which the records differ, and the values at these
// keys.
#pragma once

#include "config/tree.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Jobs of a record that differ only in the seed, so one config describes all of them.
struct PooledSetting {
  std::size_t record = 0;  ///< index of the record
  std::string record_name;
  Tree config;
  std::map<std::string, std::string> origins;  ///< see recorded_origins()
  std::map<std::string, std::string> swept;    ///< values of the keys that the record sweeps, except for the seed
};

/// Returns whether the results of a run depend on the option at `path`. They do not depend on the folder of a program,
/// for example.
bool decides_run(const std::string& path);

/// Returns the options in which the configs differ although no key in `keys` decides these options. The options of
/// plugins with different types count as one option, the plugin's block.
std::vector<std::string> further_differences(const std::vector<PooledSetting>& settings,
                                             const std::vector<std::string>& keys);

/// Returns the value of each setting at `key`, one of `keys`, as text. Two settings have the same text if and only if
/// their configs have equal values at `key`.
std::vector<std::string> pooled_values(const std::vector<PooledSetting>& settings, const std::string& key,
                                       const std::vector<std::string>& keys);

}  // namespace palpate
