// SPDX-License-Identifier: MIT
#include "launch/job.hpp"

#include "record/build_info.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <sstream>

#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAttempts = "attempts.jsonl";

/// Who tried when, and how it ended: a line at the beginning, another at the end.
class Attempt {
 public:
  Attempt(const fs::path& directory, int taps) : number_(attempts_of(directory) + 1) {
    const fs::path file = directory / kAttempts;
    std::error_code none;
    // A kill or a full disk may have left half a line, of the first attempt, too.
    if (fs::exists(file, none)) cut_file(file, read_json_lines(file).bytes);
    log_ = AppendFile(file);
    Row row = line();
    row.add("after_tap", taps);
    row.add("host", host_name());
    row.add("pid", static_cast<std::int64_t>(::getpid()));
    log_.append(to_json_line(row) + "\n", false);
  }

  void end(const char* how) {
    Row row = line();
    row.add("end", how);
    log_.append(to_json_line(row) + "\n", false);
  }

 private:
  Row line() const {
    Row row;
    row.add("attempt", number_);
    row.add("at", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())));
    return row;
  }

  AppendFile log_;
  int number_;
};

void write_failure(const fs::path& directory, const std::string& id, const std::string& reason) {
  Row row;
  row.add("id", id);
  row.add("status", "failed");
  row.add("stop_reason", reason);
  write_file(directory / "summary.json", to_json_text(row));
}

bool has_ended(const fs::path& directory) {
  const RunStatus::State state = read_ending(directory).state;
  return state == RunStatus::State::done || state == RunStatus::State::failed;
}

/// Under the lock: the run, and a summary whatever becomes of it.
JobEnd carry_on(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                const ResumeOptions& options) {
  try {
    return resume_held(workshop, config, held, options, nullptr).interrupted ? JobEnd::interrupted : JobEnd::done;
  } catch (const Error& trouble) {
    std::error_code none;
    if (!fs::exists(held.path(), none)) throw;  // nothing can be recorded there any more
    // What failed before the run could begin has left no summary.
    if (!has_ended(held.path())) write_failure(held.path(), config.id, trouble.what());
    return JobEnd::failed;
  }
}

}  // namespace

JobEnd run_job(const Workshop& workshop, const ResolvedConfig& config, const fs::path& directory,
               const ResumeOptions& options) {
  refuse_link(directory.parent_path());
  refuse_link(directory);
  std::error_code none;
  if (!fs::is_directory(directory, none)) throw Error(directory.string(), "is gone", {}, Error::Kind::run);
  std::optional<RunDirectory> held;
  try {
    held.emplace(directory);
  } catch (const Error& trouble) {
    if (trouble.kind() == Error::Kind::busy) return JobEnd::busy;
    throw;
  }
  const RunStatus::State state = read_ending(directory).state;
  if (state == RunStatus::State::done) return JobEnd::done;
  if (state == RunStatus::State::failed && !options.retry_failed) return JobEnd::failed;
  std::optional<Attempt> attempt;
  try {
    attempt.emplace(directory, read_record(directory).taps);
  } catch (const Error& trouble) {  // its record or its list of attempts is damaged
    if (!has_ended(directory)) write_failure(directory, config.id, trouble.what());
    return JobEnd::failed;
  }
  const JobEnd end = carry_on(workshop, config, *held, options);
  attempt->end(end == JobEnd::done ? "done" : end == JobEnd::failed ? "failed" : "interrupted");
  return end;
}

int attempts_of(const fs::path& directory) {
  std::error_code none;
  if (!fs::exists(directory / kAttempts, none)) return 0;
  int attempts = 0;
  std::istringstream lines(read_file(directory / kAttempts));
  // A damaged line was one, too: asking how often is no time to fail.
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    const std::optional<Row> row = parse_json_row(line);
    attempts += row && row->find("end") != nullptr ? 0 : 1;
  }
  return attempts;
}

void record_failure(const fs::path& directory, const std::string& id, const std::string& reason) {
  try {
    const RunDirectory held(directory);
    if (has_ended(directory)) return;
    write_failure(directory, id, reason);
  } catch (const Error& trouble) {
    if (trouble.kind() != Error::Kind::busy) throw;
  }
}

}  // namespace palpate
