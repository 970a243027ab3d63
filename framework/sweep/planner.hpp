// SPDX-License-Identifier: MIT
// Makes the jobs of a sweep from combinations of values, one by one.
#pragma once

#include "config/compose.hpp"
#include "host/plugin_host.hpp"
#include "record/resolved_config.hpp"
#include "sweep/description.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace palpate {

/// A function that is called with each job after its check, in the order of the jobs.
using JobSink = std::function<void(const Job& job, const ResolvedConfig& config)>;

class SweepPlanner {
 public:
  /// Treatment of a combination that gives the same run as an earlier one. `merged_if_left_out`: it is dropped if both
  /// differ only in options that the plugins of the run lack, and is an error otherwise. `dropped`: always dropped.
  enum class Repeats { merged_if_left_out, dropped };

  /// `keys`: all keys that combinations may set, in the order of Job::values. `shared`: overrides of all jobs, applied
  /// before the overrides of a job's combination. `first`: index of the first job. All arguments must outlive the
  /// object.
  SweepPlanner(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
               const std::vector<std::string>& keys, const std::vector<Override>& shared,
               Repeats repeats = Repeats::merged_if_left_out, std::size_t first = 0);

  /// Composes, resolves and checks the job of a combination, which must outlive this object, and passes it to `sink`.
  /// Throws Error.
  void add(const Combination& combination, const JobSink& sink);

  /// Throws Error for a swept key that no job uses.
  void finish() const;

  std::vector<Job> take_jobs() { return std::move(jobs_); }

 private:
  /// The use of one swept key by the jobs planned so far.
  struct KeyUse {
    const SweepAxis* asker = nullptr;  ///< axis that sets the key; null if no combination has set it yet
    bool takes_part = false;           ///< whether some job has the option
    std::set<std::string> siblings;    ///< options with the same parent as the key, for the hint of an error
  };

  std::vector<std::string> values_of(const Combination& combination, const Tree& composed,
                                     const ResolvedConfig& resolved);
  void note_siblings(std::size_t key, const ResolveNotes& notes);
  bool differs_by_what_is_left_out(std::size_t twin, const Job& job, const Combination& combination) const;
  Error same_run(const Job& twin, const Job& job) const;

  Composer& composer_;
  const PluginHost& host_;
  const std::filesystem::path& file_;
  const std::vector<Override>& shared_;
  const std::vector<std::string>& keys_;
  const Repeats repeats_;
  const std::size_t first_;
  std::vector<Job> jobs_;
  std::vector<std::string> identities_;           ///< by job
  std::vector<const Combination*> combinations_;  ///< by job
  std::unordered_map<std::string, std::size_t> key_numbers_;
  std::unordered_map<std::string, std::size_t> seen_;  ///< job number by id
  std::vector<KeyUse> uses_;                           ///< by key
};

}  // namespace palpate
