// SPDX-License-Identifier: MIT
// Which pages there are: that of the run or the sweep, and of a sweep one of each job.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"
#include "watch/live_record.hpp"

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// The pages of one directory. Nothing but what its manifest lists is ever looked for: no part of an address becomes
/// part of a path.
class Site {
 public:
  /// Throws Error for what is neither a run nor a sweep, and for a sweep that is damaged. `workshop` must outlive it.
  Site(const Workshop& workshop, const std::filesystem::path& directory);

  /// What is at `place`: "" for the directory itself, "jobs/ID/" for a job of a sweep. Null for any other. A job that
  /// nobody holds on to is let go of once eight others were asked for.
  std::shared_ptr<LiveRecord> find(std::string_view place);

  /// Whether somebody works on the record.
  bool goes_on() const { return whole_->goes_on(); }

 private:
  const Workshop& workshop_;
  std::optional<Sweep> sweep_;
  std::shared_ptr<LiveRecord> whole_;
  std::map<int, std::weak_ptr<LiveRecord>> jobs_;
  std::deque<std::shared_ptr<LiveRecord>> recent_;
};

}  // namespace palpate
