// SPDX-License-Identifier: MIT
#include "launch/job.hpp"

#include "config/catch_error.hpp"
#include "record/files.hpp"
#include "record/record_reader.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Locks the job. Returns null if another process holds the lock.
std::shared_ptr<RunDirectory> hold(const fs::path& directory) {
  std::shared_ptr<RunDirectory> held;
  const std::optional<Error> trouble = catch_error([&] { held = std::make_shared<RunDirectory>(directory); });
  if (trouble && trouble->kind() != Error::Kind::busy) throw *trouble;
  return held;
}

/// Records a failure, unless the job has already ended.
void write_failure(RunDirectory& held, const std::string& reason) {
  if (!has_ended(held.path())) held.fail(reason);
}

/// Makes one attempt at the job, whose lock is held.
JobEnd attempt_job(const RunEnvironment& environment, const std::shared_ptr<RunDirectory>& held,
                   const ResumeOptions& options) {
  const fs::path& directory = held->path();
  JobEnd end = JobEnd::failed;
  const std::optional<Error> trouble = catch_error([&] {
    const ResolvedConfig config = load_run(environment.host, directory);
    end = Run::resume(environment, config, held, options)->run().interrupted ? JobEnd::interrupted : JobEnd::done;
  });
  if (trouble) {  // the error fails this job, but the sweep continues
    // Another process uses the arm. The job has not failed and stays open.
    if (trouble->kind() == Error::Kind::busy) throw *trouble;
    if (!is_there(directory / "config.yaml")) throw *trouble;
    // The job is done, and only files made from its record are missing, which is not a failure.
    if (read_ending(directory).state == RunStatus::State::done) throw *trouble;
    // An error before the start of the run leaves no line `end` in the record, so the failure is recorded here.
    write_failure(*held, trouble->what());
  }
  return end;
}

}  // namespace

JobEnd run_job(const RunEnvironment& environment, const fs::path& directory, const ResumeOptions& options) {
  refuse_link(directory.parent_path());
  refuse_link(directory);
  std::error_code none;
  if (!fs::is_directory(directory, none))
    throw Error(directory.string(), "is missing",
                "it has no config.yaml: repeat 'palpate sweep', or resume the race, to restore it", Error::Kind::run);
  const std::shared_ptr<RunDirectory> held = hold(directory);
  if (!held) return JobEnd::busy;
  const RunStatus now = read_ending(directory);
  const bool failed = now.state == RunStatus::State::failed;
  if (now.state == RunStatus::State::done || (failed && !options.retry_failed)) {
    RestoredFiles restored;
    const auto trouble = lacks_files(directory, *now.end)
                             ? catch_error([&] { restored = restore_files(environment, *held); })
                             : std::nullopt;
    for (const std::string& name : restored.lost)
      std::fputs(
          fmt::format("{}: {} is missing or damaged, and this build computes a different one from the same taps\n",
                      directory.string(), name)
              .c_str(),
          stderr);
    // A failed job stays failed, even if its record is damaged.
    if (trouble && !failed) throw *trouble;
    return failed ? JobEnd::failed : JobEnd::done;
  }
  return attempt_job(environment, held, options);
}

bool has_ended(const fs::path& directory) { return read_ending(directory).end.has_value(); }

int attempts_of(const fs::path& directory) { return attempts_in_row(directory); }

void record_failure(const fs::path& directory, const std::string& reason) {
  if (const std::shared_ptr<RunDirectory> held = hold(directory)) write_failure(*held, reason);
}

}  // namespace palpate
