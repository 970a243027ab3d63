// SPDX-License-Identifier: MIT
#include "cli/display.hpp"

#include "analysis/sweep_table.hpp"
#include "record/fields.hpp"
#include "record/tap_row.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include <unistd.h>

namespace palpate::cli {
namespace {

std::string scaled(const std::optional<double>& value, double scale, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value * scale) : "-";
}

constexpr const char* kClearLine = "\r\x1b[K";

}  // namespace

namespace {

std::string rate_words(double per_second) {
  if (per_second >= 1.0) return fmt::format("{:.3g} a second", per_second);
  return per_second >= 1.0 / 60.0 ? fmt::format("{:.3g} a minute", 60.0 * per_second)
                                  : fmt::format("{:.3g} an hour", 3600.0 * per_second);
}

}  // namespace

std::string duration_words(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.2g} s", seconds);
  const auto minutes = static_cast<std::int64_t>(std::lround(seconds / 60.0));
  return minutes < 60 ? fmt::format("{} min", minutes) : fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

TapTable::TapTable(std::int64_t budget) : budget_(budget), terminal_(::isatty(STDOUT_FILENO) != 0) {}

void TapTable::clear_live_line() const {
  if (terminal_) mention(kClearLine, stdout);
}

void TapTable::announce(const TapRecord& tap) {
  if (!header_) {
    mention(
        fmt::format("{:>4}  {:<11}  {:>6}  {:>6}  {:>9}  {:<11}  {:>9}  {:>8}  {:>5}  {}\n", "tap", "source", "x cm",
                    "y cm", "height cm", "contact", "max sd cm", "rmse cm", "IoU", "(the last three before the tap)"),
        stdout);
    header_ = true;
  }
  if (!terminal_) return;
  mention(fmt::format("{:>4}  of {}, going to ({:.2f}, {:.2f}) cm ...", tap.number, budget_, tap.target.x * 100,
                      tap.target.y * 100),
          stdout);
  std::fflush(stdout);
}

void TapTable::record(const TapRecord& tap, const std::array<double, kPhases>&) {
  clear_live_line();
  const bool touched = tap.contact.outcome == Outcome::contact;
  const std::string contact = !touched ? outcome_name(tap.contact.outcome) : *tap.on_surface ? "object" : "desk";
  const std::string line =
      fmt::format("{:>4}  {:<11}  {:>6.2f}  {:>6.2f}  {:>9}  {:<11}  {:>9}  {:>8}  {:>5}{}\n", tap.number,
                  source_name(tap.source), tap.target.x * 100, tap.target.y * 100,
                  touched ? fmt::format("{:.2f}", tap.contact.height * 100) : std::string("-"), contact,
                  scaled(tap.max_standard_deviation, 100, "{:.2f}"), scaled(tap.errors.rmse, 100, "{:.2f}"),
                  scaled(tap.errors.footprint_iou, 1, "{:.2f}"), touched ? "" : "  " + tap.contact.reason);
  mention(line, stdout);
  std::fflush(stdout);
}

void mention(const std::string& text, std::FILE* where) { std::fputs(text.c_str(), where); }

SweepLine::SweepLine(bool quiet)
    : quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      begun_(std::chrono::steady_clock::now()),
      shown_(begun_) {}

void SweepLine::show(const SweepProgress& progress) {
  if (quiet_ || progress.jobs == 0) return;
  const auto now = std::chrono::steady_clock::now();
  const int ended = progress.done + progress.failed;
  const int tenth = 10 * ended / progress.jobs;
  if (terminal_) {
    if (!progress.last && now - shown_ < std::chrono::milliseconds(100)) return;
  } else if (tenth == tenth_) {
    return;
  }
  tenth_ = tenth;
  shown_ = now;
  std::string line = fmt::format("{} of {} jobs done, {} running, {} failed", progress.done, progress.jobs,
                                 progress.running, progress.failed);
  const double seconds = std::chrono::duration<double>(now - begun_).count();
  const int here = ended - progress.before;
  if (here > 0 && seconds > 0.0) {
    const double rate = here / seconds;
    line += fmt::format(", {}", rate_words(rate));
    if (ended < progress.jobs) line += fmt::format(", {} left", duration_words((progress.jobs - ended) / rate));
  }
  mention((terminal_ ? kClearLine : "") + line + (terminal_ && !progress.last ? "" : "\n"));
}

namespace {

/// What had to be done about rounding, in one line; empty when nothing was.
std::string numerics_line(const Row& row) {
  std::string line;
  const auto add = [&](const char* kind, const char* words) {
    const std::string count = row.cell(std::string("interventions.") + kind);
    if (count != "0" && !count.empty()) line += fmt::format(fmt::runtime(words), line.empty() ? "" : ", ", count);
  };
  add("jitter", "{}jitter was raised {} times");
  add("pivoted", "{}the covariance was pivoted {} times");
  add("set_aside", "{}{} taps were set aside");
  add("fit_failed", "{}{} fits failed");
  return line.empty() ? line : fmt::format("numerics: {}; runs/README.md says what that means\n", line);
}

}  // namespace

void print_summary(const RunReport& report) {
  const Row& row = report.summary;
  // The live line of a tap that was broken off and is made again.
  std::string text = report.interrupted && ::isatty(STDOUT_FILENO) != 0 ? kClearLine : "";
  if (report.already_done) {
    text += fmt::format("already done, nothing was repeated: {}\n", report.directory.string());
  }
  text += fmt::format("{}: {} after {} taps and {} s of robot time\n",
                      report.interrupted ? "interrupted" : row.cell("status"), row.cell("stop_reason"),
                      row.cell("taps"), scaled(row.number("robot_seconds"), 1, "{:.1f}"));
  const std::string hit = row.cell("first_hit_tap");
  text += fmt::format("taps: {} on the object, {} on the desk, {} failed; {}\n", row.cell("on_surface_taps"),
                      row.cell("off_surface_taps"), row.cell("failed_taps"),
                      hit.empty() ? "the object was not found" : "first hit at tap " + hit);
  if (const Errors errors = errors_in(row); errors.rmse) {
    text += fmt::format("error: {} cm over the scene, {} cm on the object; outline IoU {}\n",
                        scaled(errors.rmse, 100, "{:.2f}"), scaled(errors.rmse_on_surface, 100, "{:.2f}"),
                        scaled(errors.footprint_iou, 1, "{:.2f}"));
  }
  text += numerics_line(row);
  text +=
      fmt::format("{} {}\n", report.interrupted ? "carry on: palpate resume" : "record:", report.directory.string());
  mention(text, stdout);
}

void print_failures(const Sweep& sweep, const std::vector<SweepFailure>& failures) {
  constexpr std::size_t kMostLines = 20;
  for (std::size_t i = 0; i < failures.size() && i < kMostLines; ++i) {
    const SweepFailure& one = failures[i];
    const Job& job = sweep.jobs[one.job];
    std::string values;
    for (std::size_t key = 0; key < sweep.keys.size(); ++key) {
      if (!job.values[key].empty()) values += fmt::format(" {}={}", sweep.keys[key], job.values[key]);
    }
    fmt::print("failed: job {} ({}),{}, attempt {}: {}\n", job.index, job.id, values, one.attempts, one.reason);
  }
  if (failures.size() > kMostLines) {
    fmt::print("and {} more failed, results.csv has all reasons\n", failures.size() - kMostLines);
  }
}

void print_sweep(const Sweep& sweep, const std::vector<Row>& results, const SweepReport& report,
                 const std::function<std::optional<int>(std::size_t job)>& initial_taps) {
  fmt::print("{}", sweep_table(sweep, results, initial_taps));
  print_failures(sweep, report.failures);
  if (!report.failures.empty())
    fmt::print("try them again: palpate resume --retry-failed {}\n", sweep.directory.string());
  const bool open = report.interrupted || report.unfinished > 0;
  fmt::print("{} {}\n", open ? "carry on: palpate resume" : "record:", sweep.directory.string());
}

}  // namespace palpate::cli
