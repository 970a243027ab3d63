// SPDX-License-Identifier: MIT
#include "cli/display.hpp"

#include "cli/output.hpp"
#include "config/display_units.hpp"
#include "reading/read_file.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"

#include <fmt/format.h>

#include <cstdio>

#include <unistd.h>

namespace palpate::cli {
namespace {

std::string place_text(double metres) { return usual_scale(Unit::metre, LengthKind::place).number(metres); }
std::string error_text(const std::optional<double>& metres) { return usual_scale(Unit::metre).number(metres); }
std::string error_words(double metres) { return usual_scale(Unit::metre).quantity(metres); }

std::string share_text(const std::optional<double>& value) { return value ? fmt::format("{:.2f}", *value) : "-"; }

/// Returns a line such as "error: 2.6 mm over the scene (expected 3.1 mm), 5.9 mm on the object; footprint IoU 1.00".
/// If the truth is unknown, the line has only the expected error. Returns "" if the expected error is unknown, too.
std::string error_line(const Row& summary) {
  const Errors errors = errors_in(summary);
  const std::optional<double> expected = summary.number(kExpectedError);
  const std::optional<double> overall = errors.overall();
  if (!overall && !expected) return {};
  if (!overall) return fmt::format("expected error: {} over the scene\n", error_words(*expected));
  return fmt::format("error: {} over the scene{}, {} on the object{}\n", error_words(*overall),
                     expected ? fmt::format(" (expected {})", error_words(*expected)) : "",
                     errors.rmse_object ? error_words(*errors.rmse_object) : "-",
                     errors.footprint_iou ? "; footprint IoU " + share_text(errors.footprint_iou) : "");
}

/// Returns one line with the counts of numerical problems. Returns "" if there were none.
std::string numerics_line(const Row& row) {
  std::string line;
  const auto add = [&](const char* kind, const char* words) {
    const std::string count = row.cell(std::string("diagnostics.") + kind);
    if (count != "0" && !count.empty()) line += fmt::format(fmt::runtime(words), line.empty() ? "" : ", ", count);
  };
  add("jitter", "{}jitter was raised {} times");
  add("pivoted", "{}the covariance was pivoted {} times");
  add("redundant_taps", "{}{} redundant taps were left out");
  add("fit_failed", "{}{} fits failed");
  return line.empty() ? line : fmt::format("numerics: {}; runs/README.md explains these terms\n", line);
}

/// Returns a line with the taps whose final label differs from the label in the table and in taps.csv. Returns "" if
/// there are no such taps.
std::string relabelled_line(const Row& summary) {
  std::string line;
  for (const RelabelledContact& one : relabelled_in(summary))
    line += fmt::format("{}tap {} is on the {} ({} at first)", line.empty() ? "" : ", ", one.tap,
                        one.on_object ? "object" : "desk", one.on_object ? "desk" : "object");
  return line.empty() ? line : fmt::format("relabelled at the end: {}\n", line);
}

/// Returns a line such as "suspected outliers: tap 8 (0.93), tap 12 (0.61)". Returns "" if there are none.
std::string outliers_line(const Row& row) {
  const Scalar* const value = row.find("suspected_outliers");
  const auto* const list = value != nullptr ? std::get_if<JsonList>(value) : nullptr;
  std::string out;
  for (const Row& one : list != nullptr ? rows_of(*list) : std::vector<Row>())
    out += fmt::format("{} tap {} ({})", out.empty() ? "" : ",", one.cell("tap"), one.cell("probability"));
  return out.empty() ? out : "suspected outliers:" + out + "\n";
}

}  // namespace

TapTable::TapTable(std::int64_t budget) : budget_(budget), terminal_(::isatty(STDOUT_FILENO) != 0) {}

void TapTable::clear_live_line() const {
  if (terminal_) print_text(kClearLine);
}

void TapTable::announce(const TapRecord& tap) {
  if (!header_) {
    print_out("{:>4}  {:<11}  {:>6}  {:>6}  {:>9}  {:<11}  {:>11}  {:>8}  {:>5}  {}\n", "tap", "source", "x cm", "y cm",
              "height cm", "contact", "expected mm", "error mm", "IoU", "(last three columns: before the tap)");
    header_ = true;
  }
  if (!terminal_) return;
  print_out("{:>4}  of {}, going to ({}, {}) cm ...", tap.number(), budget_, place_text(tap.target().x),
            place_text(tap.target().y));
  flush_output();
}

void TapTable::record(const TapRecord& tap, const std::array<double, kPhases>&) {
  clear_live_line();
  const bool touched = tap.is_contact();
  const std::string contact = !touched ? outcome_name(tap.result.outcome) : tap.reading->on_object ? "object" : "desk";
  const std::string line = fmt::format(
      "{:>4}  {:<11}  {:>6}  {:>6}  {:>9}  {:<11}  {:>11}  {:>8}  {:>5}{}\n", tap.number(),
      source_name(tap.request.source), place_text(tap.target().x), place_text(tap.target().y),
      touched ? place_text(tap.result.height()) : std::string("-"), contact, error_text(tap.shown_expected_rmse),
      error_text(tap.errors.overall()), share_text(tap.errors.footprint_iou), touched ? "" : "  " + tap.result.reason);
  print_text(line);
  flush_output();
}

std::string displayable(std::string_view text) {
  const bool clears = text.substr(0, kClearLine.size()) == kClearLine;
  return std::string(clears ? kClearLine : "") + printable(text.substr(clears ? kClearLine.size() : 0));
}

void print_message(const std::string& text) {
  // If stdout and stderr are the same file, flushing first keeps the order of the texts.
  flush_output();
  std::fputs(displayable(text).c_str(), stderr);
}

std::string record_line(const RunConclusion& report) {
  return fmt::format("{} {}",
                     report.interrupted ? "resume with: palpate resume" : "record:", report.directory.string());
}

void print_summary(const RunConclusion& report) {
  const Row& row = report.summary;
  // Erases the live line of the interrupted tap.
  std::string text = report.interrupted && ::isatty(STDOUT_FILENO) != 0 ? std::string(kClearLine) : "";
  if (report.already_done) text += fmt::format("already done, not run again: {}\n", report.directory.string());
  for (const std::string& name : report.restored.made) text += fmt::format("rebuilt from the record: {}\n", name);
  for (const std::string& name : report.restored.lost)
    text += fmt::format("{} is missing or damaged, and this build computes a different one from the same taps\n", name);
  const std::optional<double> seconds = row.number("robot_seconds");
  text += fmt::format("{}: {} after {} taps and {} of robot time\n",
                      report.interrupted ? "interrupted" : row.cell("status"), row.cell("stop_reason"),
                      row.cell("taps"), seconds ? usual_scale(Unit::second).quantity(*seconds) : "-");
  const std::string hit = row.cell("first_hit_tap");
  const std::string missed =
      row.find("no_contact_taps") != nullptr ? fmt::format(" {} that met nothing,", row.cell("no_contact_taps")) : "";
  text += fmt::format("taps: {} on the object, {} on the desk,{} {} failed; {}\n", row.cell("object_taps"),
                      row.cell("desk_taps"), missed, row.cell("failed_taps"),
                      hit.empty() ? "no object was found" : "first hit at tap " + hit);
  text += relabelled_line(row);
  text += error_line(row);
  text += outliers_line(row);
  text += numerics_line(row);
  print_text(text + record_line(report) + "\n");
}

}  // namespace palpate::cli
