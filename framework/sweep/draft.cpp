// SPDX-License-Identifier: MIT
#include "sweep/draft.hpp"

#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

Error cannot(const fs::path& what, const std::string& why) {
  return Error(what.string(), "cannot be made: " + why, {}, Error::Kind::run);
}

constexpr const char* kPrefix = ".sweep-";

/// Removes drafts whose lock is free. Keeps drafts younger than one minute, because their processes may not have locked
/// them yet.
void remove_abandoned(const fs::path& runs) {
  constexpr auto kYoung = std::chrono::minutes(1);
  std::error_code none;
  for (const fs::path& draft : list_folder(runs)) {
    if (draft.filename().string().rfind(kPrefix, 0) != 0) continue;
    const fs::path lock = draft / "lock";
    const auto made = fs::last_write_time(lock, none);
    if (!none && fs::file_time_type::clock::now() - made > kYoung && !FileLock::is_held(lock))
      fs::remove_all(draft, none);
  }
}

}  // namespace

SweepDraft::SweepDraft(fs::path runs) : runs_(std::move(runs)), made_runs_(!fs::exists(runs_)) {
  make_folder(runs_);
  remove_abandoned(runs_);
  std::string name = (runs_ / kPrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw cannot(name, std::strerror(errno));
  folder_ = name;
  std::error_code none;
  fs::permissions(folder_, fs::status(runs_).permissions(), none);  // mkdtemp denies access to other users
  make_folder(folder_ / "jobs");
  lock_ = FileLock(folder_ / "lock");
}

SweepDraft::~SweepDraft() {
  std::error_code none;
  fs::remove_all(folder_, none);
  if (made_runs_) fs::remove(runs_, none);  // only if it is empty
}

void SweepDraft::add(const Job& job, const ResolvedConfig& config) {
  const fs::path directory = job_directory(job);
  make_folder(directory);
  // No temporary file is needed, because no other process reads the folder before the folder gets its final name.
  AppendFile file(directory / "config.yaml");
  file.append(to_yaml_with_places(config.tree), false);
  file.flush();
}

void SweepDraft::replace_lost(const Sweep& sweep) const {
  for (const Job& job : sweep.jobs) {
    const fs::path directory = palpate::job_directory(sweep, job);
    if (is_there(directory / "config.yaml")) continue;
    refuse_link(directory.parent_path());
    make_inner_folder(directory);
    write_file(directory / "config.yaml", read_file(folder_ / "jobs" / job.id / "config.yaml"));
  }
}

bool SweepDraft::publish(const SweepPlan& plan) {
  const fs::path& directory = plan.sweep.directory;
  if (is_sweep(directory)) {
    replace_lost(plan.sweep);
    return false;
  }
  write_file(folder_ / "config.yaml", to_yaml(plan.config));
  write_file(folder_ / "manifest.jsonl", manifest_text(plan.sweep, directory.filename().string()));
  make_folder(directory.parent_path());
  std::error_code trouble;
  fs::rename(folder_, directory, trouble);
  if (!trouble) {
    folder_.clear();
    return true;
  }
  // Another process has published the same sweep meanwhile.
  if (is_sweep(directory)) return false;
  throw cannot(directory, trouble.message());
}

}  // namespace palpate
