// SPDX-License-Identifier: MIT
// Makes the jobs of a tuned sweep: settings of the tuned keys, each on several seeds.
#pragma once

#include "config/compose.hpp"
#include "host/plugin_host.hpp"
#include "record/resolved_config.hpp"
#include "sweep/planner.hpp"
#include "tune/description.hpp"
#include "tune/search_space.hpp"

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The values of the tuned keys in a setting. A key without a value keeps the value of the config.
using SettingValues = std::vector<std::optional<Tree>>;

/// A setting, and the seeds on which it runs. Seed k is the config's seed plus k; with several scenes, the scene
/// alternates from seed to seed.
struct PlannedSetting {
  SettingValues values;
  std::size_t first_seed = 0;
  std::size_t end_seed = 0;
};

class TunePlanner {
 public:
  /// `file`: a config without the values of the tuned keys. Throws Error if the config cannot be run as it stands.
  /// `composer`, `host` and `description` must outlive the object.
  TunePlanner(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
              const TuneDescription& description);
  TunePlanner(const TunePlanner&) = delete;
  TunePlanner& operator=(const TunePlanner&) = delete;

  const TuneDescription& description() const { return description_; }
  const SearchSpace& space() const { return *space_; }
  /// Returns the keys of the jobs in the order of Job::values.
  const std::vector<std::string>& keys() const { return keys_; }
  /// Returns the config as it stands.
  const ResolvedConfig& own() const { return *own_; }

  /// Returns the values at a point of the space.
  SettingValues values_at(const Point& point) const { return values_in(*space_, point); }
  /// Returns whether the conditions of the description hold for a setting, with all options as it has them. Throws
  /// Error for an unknown name.
  bool is_wanted(const SettingValues& values) const;

  /// Returns the jobs of the settings, seed by seed. A job that is equal to an earlier one is left out, for example if
  /// two settings differ only in an option that their plugins lack. `first`: index of the first job. With `is_first`,
  /// throws Error for a tuned key that no job has.
  std::vector<Job> plan(const std::vector<PlannedSetting>& settings, std::size_t first, bool is_first,
                        const JobSink& sink) const;

  /// Returns the config that next rounds are planned from, with the block `tune:`.
  Tree written() const;

 private:
  /// The axes and the combination of one job; a combination points to its axes.
  struct JobValues {
    std::deque<SweepAxis> axes;
    Combination combination;
    void add(const std::string& key, const Tree& value);
  };

  JobValues job_values(const SettingValues& values, std::optional<std::size_t> seed) const;
  static SettingValues values_in(const SearchSpace& space, const Point& point);
  std::vector<bool> find_whole_keys() const;
  /// Returns the config of a job. Throws Error.
  ResolvedConfig resolved(const SettingValues& values, std::optional<std::size_t> seed) const;
  /// Returns whether the job of these values can be resolved.
  bool is_valid(const SettingValues& values) const;

  Composer& composer_;
  const PluginHost& host_;
  std::filesystem::path file_;
  const TuneDescription& description_;
  Tree base_;
  std::vector<Override> shared_;
  std::optional<ResolvedConfig> own_;
  std::vector<std::string> keys_;
  std::optional<SearchSpace> space_;
};

}  // namespace palpate
