// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "config/trouble.hpp"
#include "record/json.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSummary = "summary.json";

}  // namespace

const char* state_name(RunStatus::State state) {
  constexpr std::array<const char*, 5> kNames{"missing", "running", "unfinished", "done", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

bool is_sweep(const fs::path& directory) { return is_there(directory / "manifest.jsonl"); }

std::optional<Row> read_summary(const fs::path& directory) {
  // A power cut may leave its name without its content.
  return read_json_row(directory / kSummary,
                       "the file is damaged: remove it, and 'palpate resume' makes it anew from the taps");
}

std::optional<Row> read_outcome(const fs::path& directory) {
  std::optional<Row> out;
  if (const auto trouble = trouble_in([&] { out = read_summary(directory); })) {
    if (trouble->kind() == Error::Kind::run) throw *trouble;  // a file system that fails tells nothing of the run
    out.emplace().add("status", "failed");
    out->add("stop_reason", trouble->what());
  }
  return out;
}

void check_complete(const Row& summary, int recorded, const fs::path& directory) {
  const std::optional<double> made = summary.number("taps");
  if (summary.text("status") != "done" || !made || *made <= recorded) return;
  throw Error(RunFiles(directory).taps_file().string(),
              fmt::format("holds {} of the {} taps that were made", recorded, *made),
              "the file was cut: put it back, or remove summary.json, and 'palpate resume' makes the others again");
}

namespace {

RunStatus ending_of(const fs::path& directory, const RunFiles& files) {
  RunStatus out;
  if (const std::optional<Row> summary = read_outcome(directory)) {
    out.state = summary->text("status") == "done" ? RunStatus::State::done : RunStatus::State::failed;
    out.stop_reason = summary->text("stop_reason");
  } else if (files.begun()) {
    out.state = RunStatus::State::unfinished;
  }
  return out;
}

}  // namespace

RunStatus read_ending(const fs::path& directory) { return ending_of(directory, RunFiles(directory)); }

bool is_running(const fs::path& directory) { return FileLock::is_held(RunFiles(directory).lock_file()); }

RunStatus read_record(const fs::path& directory) {
  const RunFiles files(directory);
  RunStatus out = ending_of(directory, files);
  if (out.state != RunStatus::State::absent && files.begun()) {
    for (const Row& row : files.taps()) out.taps += is_intent(row) ? 0 : 1;
  }
  if (out.state == RunStatus::State::done) check_complete(read_summary(directory).value(), out.taps, directory);
  return out;
}

RunStatus read_status(const fs::path& directory) {
  // Asked first: who ends between the two questions has written what the second one reads.
  const bool held = is_running(directory);
  RunStatus out = read_record(directory);
  if (held && out.state != RunStatus::State::done) out.state = RunStatus::State::running;
  return out;
}

RunDirectory::RunDirectory(const fs::path& directory) : path_(directory), files_(path_) {
  remove_temporaries(path_);
  remove_temporaries(path_ / "maps");
}

std::vector<PastTap> RunDirectory::recover() {
  if (!files_.begun()) return {};
  std::optional<Row> intent;
  for (Row& row : files_.taps()) {
    if (is_intent(row)) {
      intent = std::move(row);
      continue;
    }
    intent.reset();
    rows_.push_back(std::move(row));
  }
  if (intent) {
    rows_.push_back(unknown_result_of(*intent));
    files_.add_tap(rows_.back(), nullptr, true);
  }
  if (rows_.empty()) return {};
  files_.mend(rows_);
  for (const TapTimes& tap : files_.timings().taps) {
    for (std::size_t i = 0; i < kPhases; ++i) total_[i] += tap.seconds[i];
  }
  return past_taps(rows_, files_.taps_file());
}

void RunDirectory::sync() { sync_ = true; }

void RunDirectory::open(bool announce) {
  announce_ = announce;
  files_.open();
  // Lines that are on the disk are lost all the same if no name leads to them.
  if (sync_) sync_names(path_);
}

void RunDirectory::announce(const TapRecord& tap) {
  check_in_place();
  if (announce_) files_.add_tap(intent_row(tap), nullptr, sync_);
}

void RunDirectory::record(const TapRecord& tap, const std::array<double, kPhases>& seconds) {
  Row row = tap_row(tap);
  const TapTimes times{tap.number, seconds};
  files_.add_tap(row, &times, sync_);
  rows_.push_back(std::move(row));
  for (std::size_t i = 0; i < kPhases; ++i) total_[i] += seconds[i];
}

}  // namespace palpate
