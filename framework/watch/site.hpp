// SPDX-License-Identifier: MIT
// The pages of a directory: the page of a run, or the pages of a sweep and its jobs.
#pragma once

#include "record/run.hpp"
#include "sweep/sweep.hpp"
#include "watch/live_record.hpp"

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>

namespace palpate {

/// The pages of one directory. Only jobs of the manifest have pages. No part of a requested address becomes part of a
/// path.
class Site {
 public:
  /// Throws Error for a directory without a run or sweep, and for a damaged sweep. `environment` must outlive the
  /// object.
  Site(const RunEnvironment& environment, const std::filesystem::path& directory);

  /// Returns the record at `place`. The place is "" for the directory itself and "jobs/ID/" for a job of a sweep.
  /// Returns null for any other place. The eight jobs that were used last stay in memory.
  std::shared_ptr<LiveRecord> find(std::string_view place);

  /// Returns whether a process works on the record.
  bool goes_on() const { return main_->goes_on(); }

 private:
  const RunEnvironment& environment_;
  std::optional<Sweep> sweep_;
  std::shared_ptr<LiveRecord> main_;
  std::map<int, std::weak_ptr<LiveRecord>> jobs_;
  std::deque<std::shared_ptr<LiveRecord>> recent_;
};

}  // namespace palpate
