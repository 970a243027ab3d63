// SPDX-License-Identifier: MIT
#include "launch/job.hpp"

#include "config/trouble.hpp"
#include "record/build_info.hpp"
#include "record/files.hpp"
#include "record/run_directory.hpp"
#include "record/run_files.hpp"

#include <palpate/error.hpp>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <optional>

#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Who tried when, and how it ended: a line at the beginning, another at the end.
class Attempt {
 public:
  Attempt(HeldFiles& files, int taps) : files_(files), number_(files.attempts() + 1) {
    note({{{"after_tap", std::int64_t{taps}}, {"host", host_name()}, {"pid", std::int64_t{::getpid()}}}});
  }

  void end(const std::string& how) { note({{{"end", how}}}); }

 private:
  void note(const Row& what) {
    Row row;
    row.add("attempt", number_);
    row.add("at", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())));
    row.fields.insert(row.fields.end(), what.fields.begin(), what.fields.end());
    files_.add_attempt(row);
  }

  HeldFiles& files_;
  int number_;
};

/// None if another process has it in hand.
std::optional<RunDirectory> hold(const fs::path& directory) {
  std::optional<RunDirectory> held;
  const std::optional<Error> trouble = trouble_in([&] { held.emplace(directory); });
  if (trouble && trouble->kind() != Error::Kind::busy) throw *trouble;
  return held;
}

/// Its reason is kept unless the job has ended for another one.
void write_failure(const fs::path& directory, const std::string& reason) {
  if (has_ended(directory)) return;
  Row row;
  row.add("id", directory.filename().string());
  row.add("status", "failed");
  row.add("stop_reason", reason);
  write_file(directory / "summary.json", to_json_text(row));
}

/// Under the lock: the attempt from its beginning to its end.
JobEnd attempt_job(const Workshop& workshop, const std::function<ResolvedConfig()>& config_of, RunDirectory& held,
                   const ResumeOptions& options) {
  const fs::path& directory = held.path();
  JobEnd end = JobEnd::failed;
  std::optional<Attempt> attempt;
  const std::optional<Error> trouble = trouble_in([&] {
    const ResolvedConfig config = config_of();
    attempt.emplace(held.files(), read_record(directory).taps);
    end = resume_held(workshop, config, held, options, nullptr).interrupted ? JobEnd::interrupted : JobEnd::done;
  });
  if (trouble) {  // ends the job alone, not the sweep
    if (!is_there(directory / "config.yaml")) throw *trouble;
    // What failed before the run could begin has left no summary.
    write_failure(directory, trouble->what());
  }
  if (attempt) attempt->end(end == JobEnd::done ? "done" : end == JobEnd::failed ? "failed" : "interrupted");
  return end;
}

}  // namespace

JobEnd run_job(const Workshop& workshop, const std::function<ResolvedConfig()>& config_of, const fs::path& directory,
               const ResumeOptions& options) {
  refuse_link(directory.parent_path());
  refuse_link(directory);
  std::error_code none;
  if (!fs::is_directory(directory, none)) {
    throw Error(directory.string(), "is gone", "it has no config.yaml: 'palpate sweep' puts it back", Error::Kind::run);
  }
  std::optional<RunDirectory> held = hold(directory);
  if (!held) return JobEnd::busy;
  const RunStatus::State state = read_ending(directory).state;
  if (state == RunStatus::State::done) return JobEnd::done;
  if (state == RunStatus::State::failed && !options.retry_failed) return JobEnd::failed;
  return attempt_job(workshop, config_of, *held, options);
}

// A damaged summary is an end, too: a failure.
bool has_ended(const fs::path& directory) { return is_there(directory / "summary.json"); }

int attempts_of(const fs::path& directory) { return RunFiles(directory).attempts(); }

void record_failure(const fs::path& directory, const std::string& reason) {
  if (const std::optional<RunDirectory> held = hold(directory)) write_failure(directory, reason);
}

}  // namespace palpate
