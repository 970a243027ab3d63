// SPDX-License-Identifier: MIT
#include "watch/site.hpp"

#include "record/run_directory.hpp"
#include "watch/run_follower.hpp"
#include "watch/sweep_follower.hpp"

#include <algorithm>

namespace palpate {

Site::Site(const RunEnvironment& environment, const std::filesystem::path& directory) : environment_(environment) {
  if (is_sweep(directory)) {
    sweep_ = read_sweep(directory);
    main_ = std::make_shared<SweepFollower>(*sweep_);
  } else {
    read_run_config(directory);  // throws Error if there is no run
    main_ = std::make_shared<RunFollower>(environment, directory);
  }
}

std::shared_ptr<LiveRecord> Site::find(std::string_view place) {
  constexpr std::size_t kMostKept = 8;
  if (place.empty()) return main_;
  if (!sweep_) return nullptr;
  const auto job = std::find_if(sweep_->jobs.begin(), sweep_->jobs.end(),
                                [&](const Job& one) { return place == "jobs/" + one.id + "/"; });
  if (job == sweep_->jobs.end()) return nullptr;
  std::weak_ptr<LiveRecord>& known = jobs_[job->index];
  std::shared_ptr<LiveRecord> out = known.lock();
  if (!out) known = out = std::make_shared<RunFollower>(environment_, job_directory(*sweep_, *job));
  recent_.erase(std::remove(recent_.begin(), recent_.end(), out), recent_.end());
  recent_.push_back(out);
  if (recent_.size() > kMostKept) recent_.pop_front();
  return out;
}

}  // namespace palpate
