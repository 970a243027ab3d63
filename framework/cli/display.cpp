// SPDX-License-Identifier: MIT
#include "cli/display.hpp"

#include "record/tap_row.hpp"

#include <fmt/format.h>

#include <cstdio>

#include <unistd.h>

namespace palpate::cli {
namespace {

std::string scaled(const std::optional<double>& value, double scale, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value * scale) : "-";
}

std::string text_at(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : std::string();
}

/// A number of a summary times `scale`, "-" where it is null.
std::string number_at(const Row& row, const char* name, double scale, const char* format) {
  const std::string text = text_at(row, name);
  return text.empty() ? "-" : fmt::format(fmt::runtime(format), std::stod(text) * scale);
}

}  // namespace

TapTable::TapTable(std::int64_t budget) : budget_(budget), terminal_(::isatty(STDOUT_FILENO) != 0) {}

void TapTable::clear_live_line() const {
  if (terminal_) fmt::print("\r\x1b[K");
}

void TapTable::announce(const TapRecord& tap) {
  if (!header_) {
    fmt::print("{:>4}  {:<11}  {:>6}  {:>6}  {:>9}  {:<11}  {:>9}  {:>8}  {:>5}\n", "tap", "source", "x cm", "y cm",
               "height cm", "contact", "max sd cm", "rmse cm", "IoU");
    header_ = true;
  }
  if (!terminal_) return;
  fmt::print("{:>4}  of {}, going to ({:.2f}, {:.2f}) cm ...", tap.number, budget_, tap.target.x * 100,
             tap.target.y * 100);
  std::fflush(stdout);
}

void TapTable::record(const TapRecord& tap, const std::array<double, kPhases>&) {
  clear_live_line();
  const bool touched = tap.contact.outcome == Outcome::contact;
  const std::string contact = !touched ? outcome_name(tap.contact.outcome) : *tap.on_surface ? "object" : "desk";
  const char* source = tap.source == Source::initial    ? "initial"
                       : tap.source == Source::fallback ? "fallback"
                                                        : "acquisition";
  fmt::print("{:>4}  {:<11}  {:>6.2f}  {:>6.2f}  {:>9}  {:<11}  {:>9}  {:>8}  {:>5}{}\n", tap.number, source,
             tap.target.x * 100, tap.target.y * 100,
             touched ? fmt::format("{:.2f}", tap.contact.height * 100) : std::string("-"), contact,
             scaled(tap.max_standard_deviation, 100, "{:.2f}"), scaled(tap.errors.rmse, 100, "{:.2f}"),
             scaled(tap.errors.footprint_iou, 1, "{:.2f}"), touched ? "" : "  " + tap.contact.reason);
  std::fflush(stdout);
}

SweepLine::SweepLine(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

void SweepLine::show(const SweepProgress& progress) {
  if (quiet_) return;
  const int tenth = 10 * progress.done / progress.jobs;
  const bool last = progress.done == progress.jobs;
  if (terminal_ ? false : tenth == tenth_) return;
  tenth_ = tenth;
  fmt::print(stderr, "{}{} of {} jobs, {} failed{}", terminal_ ? "\r\x1b[K" : "", progress.done, progress.jobs,
             progress.failed, terminal_ && !last ? "" : "\n");
}

namespace {

/// What had to be done about rounding, in one line; none when nothing was.
void print_numerics(const Row& row) {
  std::string line;
  const auto add = [&](const char* kind, const char* words) {
    const std::string count = number_at(row, (std::string("interventions.") + kind).c_str(), 1, "{:.0f}");
    if (count != "0" && count != "-") line += fmt::format(fmt::runtime(words), line.empty() ? "" : ", ", count);
  };
  add("jitter", "{}jitter was raised {} times");
  add("pivoted", "{}the covariance was pivoted {} times");
  add("set_aside", "{}{} taps were set aside");
  add("fit_failed", "{}{} fits failed");
  if (!line.empty()) fmt::print("numerics: {}; runs/README.md says what that means\n", line);
}

}  // namespace

void print_summary(const RunReport& report) {
  const Row& row = report.summary;
  if (report.already_done) {
    fmt::print("already done, nothing was repeated: {}\n", report.directory.string());
  }
  fmt::print("{}: {} after {} taps and {} s of robot time\n",
             report.interrupted ? "interrupted" : text_at(row, "status"), text_at(row, "stop_reason"),
             text_at(row, "taps"), number_at(row, "robot_seconds", 1, "{:.1f}"));
  const std::string hit = text_at(row, "first_hit_tap");
  fmt::print("taps: {} on the object, {} on the desk, {} failed; {}\n", text_at(row, "on_surface_taps"),
             text_at(row, "off_surface_taps"), text_at(row, "failed_taps"),
             hit.empty() ? "the object was not found" : "first hit at tap " + hit);
  if (!text_at(row, "rmse_m").empty()) {
    fmt::print("error: {} cm over the scene, {} cm on the object; outline IoU {}\n",
               number_at(row, "rmse_m", 100, "{:.2f}"), number_at(row, "rmse_on_surface_m", 100, "{:.2f}"),
               number_at(row, "footprint_iou", 1, "{:.2f}"));
  }
  print_numerics(row);
  fmt::print("{} {}\n", report.interrupted ? "carry on: palpate resume" : "record:", report.directory.string());
}

void print_sweep(const Sweep& sweep, const SweepReport& report, int initial_taps) {
  fmt::print("{}", sweep_table(sweep, sweep_results(sweep), initial_taps));
  for (const auto& [job, reason] : report.failures) {
    fmt::print("failed: job {} ({}): {}\n", job.index, job.id, reason);
  }
  fmt::print("{} {}\n", report.interrupted ? "carry on: palpate resume" : "record:", sweep.directory.string());
}

}  // namespace palpate::cli
