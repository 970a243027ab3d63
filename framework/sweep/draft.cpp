// SPDX-License-Identifier: MIT
#include "sweep/draft.hpp"

#include "config/yaml.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <cerrno>
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

void make_folder(const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) throw cannot(folder, trouble.message());
}

}  // namespace

SweepDraft::SweepDraft(fs::path runs) : runs_(std::move(runs)), made_runs_(!fs::exists(runs_)) {
  make_folder(runs_);
  std::string name = (runs_ / ".sweep-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw cannot(name, std::strerror(errno));
  folder_ = name;
  std::error_code none;
  fs::permissions(folder_, fs::status(runs_).permissions(), none);  // mkdtemp keeps others out
  make_folder(folder_ / "jobs");
}

SweepDraft::~SweepDraft() {
  std::error_code none;
  fs::remove_all(folder_, none);
  if (made_runs_) fs::remove(runs_, none);  // only while it is empty
}

void SweepDraft::add(const Job& job, const ResolvedConfig& config) {
  const fs::path directory = folder_ / "jobs" / job.id;
  make_folder(directory);
  std::string text;
  for (const Tree::Entry& entry : config.tree.entries) {
    Written& known = written_[entry.key];
    std::string value = entry.value.canonical();
    if (known.yaml.empty() || known.value != value) {
      Tree alone = Tree::map();
      alone.entries.push_back(entry);
      known = {std::move(value), to_yaml(alone)};
    }
    text += known.yaml;
  }
  write_file(directory / "config.yaml", text);
}

bool SweepDraft::publish(const SweepPlan& plan) {
  const fs::path& directory = plan.sweep.directory;
  if (is_sweep(directory)) return false;
  write_file(folder_ / "config.yaml", to_yaml(plan.config));
  std::string manifest;
  for (const Job& job : plan.sweep.jobs) manifest += to_json_line(manifest_row(plan.sweep.keys, job)) + "\n";
  write_file(folder_ / "manifest.jsonl", manifest);
  make_folder(directory.parent_path());
  std::error_code trouble;
  fs::rename(folder_, directory, trouble);
  if (!trouble) {
    folder_.clear();
    return true;
  }
  // Another process may have been faster; what is there is then equal.
  if (is_sweep(directory)) return false;
  throw cannot(directory, trouble.message());
}

}  // namespace palpate
