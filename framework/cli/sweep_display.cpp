// SPDX-License-Identifier: MIT
#include "cli/sweep_display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"

#include "cli/display.hpp"
#include "config/hash.hpp"
#include "launch/parallel_children.hpp"
#include "record/catalogue.hpp"
#include "sweep/pooled_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <unistd.h>

namespace palpate::cli {
namespace {

std::string rate_words(double per_second) {
  if (per_second >= 1.0) return fmt::format("{:.3g} per second", per_second);
  return per_second >= 1.0 / 60.0 ? fmt::format("{:.3g} per minute", 60.0 * per_second)
                                  : fmt::format("{:.3g} per hour", 3600.0 * per_second);
}

/// Returns a text such as "12 s", "8 min" or "3 h 05 min".
std::string duration_words(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.2g} s", seconds);
  const auto minutes = static_cast<std::int64_t>(std::lround(seconds / 60.0));
  return minutes < 60 ? fmt::format("{} min", minutes) : fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

}  // namespace

SweepLine::SweepLine(bool quiet)
    : quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      begun_(std::chrono::steady_clock::now()),
      shown_(begun_) {}

void SweepLine::show(const SweepProgress& progress, std::string line) {
  if (quiet_ || progress.jobs == 0) return;
  const auto now = std::chrono::steady_clock::now();
  const int ended = progress.done + progress.failed;
  const int tenth = 10 * ended / progress.jobs;
  if (terminal_ || is_followed()) {
    if (!progress.last && now - shown_ < std::chrono::milliseconds(100)) return;
  } else if (tenth == tenth_ && (!progress.last || running_ == 0)) {
    return;
  }
  tenth_ = tenth;
  running_ = progress.running;
  shown_ = now;
  if (line.empty())
    line = fmt::format("{} of {} jobs done, {} running, {} failed", progress.done, progress.jobs, progress.running,
                       progress.failed);
  const double seconds = std::chrono::duration<double>(now - begun_).count();
  const int here = ended - progress.before;
  if (here > 0 && seconds > 0.0) {
    const double rate = here / seconds;
    line += fmt::format(", {}", rate_words(rate));
    if (ended < progress.jobs) line += fmt::format(", {} left", duration_words((progress.jobs - ended) / rate));
  }
  print_message(std::string(terminal_ ? kClearLine : "") + line + (terminal_ && !progress.last ? "" : "\n"));
}

bool compute_jobs(const CommandEnvironment& program, const std::vector<std::size_t>& jobs, std::optional<int> workers,
                  const std::function<void(std::size_t job)>& work) {
  const int together = workers.value_or(cores());
  SweepLine line(false);
  SweepProgress progress;
  progress.jobs = static_cast<int>(jobs.size());
  const auto show = [&](std::size_t done) {
    progress.done = static_cast<int>(done);
    progress.running = std::min(together, progress.jobs - progress.done);
    progress.last = done == jobs.size();
    line.show(progress);
  };
  listen_for_interrupts();
  return in_children(
      jobs.size(), together, [&](std::size_t i) { work(jobs[i]); }, program.interrupted, show);
}

Sweep read_records(const std::vector<std::string>& words, const std::vector<std::string>& by) {
  PooledSweep pooled = read_pooled(find_records(words), by);
  for (const std::string& note : pooled.notes) print_message("note: " + note + "\n");
  return std::move(pooled.sweep);
}

std::string where_suffix(const std::string& where) {
  constexpr std::size_t kDigits = 6;
  return where.empty() ? "" : "_where_" + hash_of(where).substr(0, kDigits);
}

std::string values_text(const Sweep& sweep, const Job& job, const char* gap) {
  std::string out;
  for (std::size_t i = 0; i < sweep.keys.size(); ++i) {
    if (!job.values[i].empty()) out += fmt::format("{}{}={}", gap, sweep.keys[i], job.values[i]);
  }
  return out;
}

void print_failures(const Sweep& sweep, const std::vector<FailedJob>& failures) {
  constexpr std::size_t kMostLines = 20;
  for (std::size_t i = 0; i < failures.size() && i < kMostLines; ++i) {
    const FailedJob& one = failures[i];
    const Job& job = sweep.jobs[one.job];
    print_out("failed: job {} ({}),{}, attempt {}: {}\n", job.index, job.id, values_text(sweep, job, " "), one.attempts,
              one.reason);
  }
  if (failures.size() > kMostLines)
    print_out("and {} more failed, results.csv has all reasons\n", failures.size() - kMostLines);
}

}  // namespace palpate::cli
