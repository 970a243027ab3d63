// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "config/catch_error.hpp"
#include "config/hash.hpp"
#include "record/build_info.hpp"
#include "record/json.hpp"

#include <palpate/error.hpp>

#include <algorithm>

#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

RunStatus status_of(std::optional<Ending> end, bool begun) {
  RunStatus out;
  if (end && end->how != Ending::EndKind::interrupted) {
    out.state = end->how == Ending::EndKind::done ? RunStatus::State::done : RunStatus::State::failed;
    out.stop_reason = end->reason;
    out.end = std::move(end);
  } else if (begun) {
    out.state = RunStatus::State::unfinished;
  }
  return out;
}

/// Returns the end of a run from its record. A run with a damaged last line counts as failed, with the damage as its
/// reason.
RecordEnd end_of(const fs::path& directory) {
  RecordEnd out;
  if (const auto trouble = catch_error([&] { out = read_record_end(directory); })) {
    if (trouble->kind() == Error::Kind::run) throw *trouble;  // this error says nothing about the run
    out.begun = true;
    out.end.emplace();
    out.end->how = Ending::EndKind::failed;
    out.end->reason = trouble->what();
    out.end->summary.add("status", "failed");
    out.end->summary.add("stop_reason", trouble->what());
  }
  return out;
}

std::optional<Row> summary_of(RecordEnd record) {
  if (!record.end || record.end->how == Ending::EndKind::interrupted) return std::nullopt;
  return std::move(record.end->summary);
}

}  // namespace

const char* state_name(RunStatus::State state) {
  constexpr std::array<const char*, 5> kNames{"missing", "running", "unfinished", "done", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

bool is_sweep(const fs::path& directory) { return is_there(directory / "manifest.jsonl"); }

std::optional<Row> read_summary(const fs::path& directory) { return summary_of(read_record_end(directory)); }

std::optional<Row> read_outcome(const fs::path& directory) { return summary_of(end_of(directory)); }

RunStatus read_ending(const fs::path& directory) {
  RecordEnd record = end_of(directory);
  return status_of(std::move(record.end), record.begun);
}

RunStatus read_standing(const fs::path& directory) {
  RunStatus now = read_ending(directory);
  if (now.state == RunStatus::State::done) return now;
  if (is_running(directory)) return {RunStatus::State::running, 0, ""};
  // A process may end between the two checks and record its end after the first check, so the record is read again.
  return read_ending(directory);
}

bool lacks_files(const fs::path& directory, const Ending& end) {
  // A power cut may leave summary.json empty. Its size is not recorded, so no other damage of this file is detected.
  if (size_if_there((directory / kSummaryFile).c_str()).value_or(0) == 0) return true;
  return std::any_of(end.files.begin(), end.files.end(), [&](const Ending::ListedFile& one) {
    return size_if_there((directory / one.name).c_str()) != one.bytes;
  });
}

bool is_running(const fs::path& directory) { return FileLock::is_held(directory / kRecordFile); }

RunStatus read_record(const fs::path& directory) {
  RunRecord record = read_run_record(directory);
  RunStatus out = status_of(std::move(record.end), record.manifest.has_value());
  out.taps = static_cast<int>(record.taps.size());
  if (out.end) {
    out.expected_rmse = out.end->summary.number(kExpectedError);
  } else if (!record.timings.empty() && record.timings.back().tap == out.taps) {
    out.expected_rmse = record.timings.back().expected_rmse;
  }
  out.cut = !out.end && is_there(directory / kSummaryFile);
  return out;
}

RunStatus read_status(const fs::path& directory) {
  // The lock is checked first. If a process ends between the two checks, the record then already contains the process's
  // end.
  const bool held = is_running(directory);
  RunStatus out = read_record(directory);
  if (held && out.state != RunStatus::State::done) out.state = RunStatus::State::running;
  return out;
}

RunDirectory::RunDirectory(const fs::path& directory) : path_(directory), record_(path_) {
  remove_temporaries(path_);
  if (const fs::path maps = path_ / "maps"; !fs::is_symlink(maps)) remove_temporaries(maps);
}

void RunDirectory::write_config(const std::string& text) const {
  record_.check_in_place();
  write_file(path_ / "config.yaml", text, true);
}

void RunDirectory::begin(const Tree& manifest) {
  Tree line = Tree::map({{"manifest", Tree::scalar(std::to_string(kRecordVersion))}});
  line.entries.insert(line.entries.end(), manifest.entries.begin(), manifest.entries.end());
  record_.add_manifest(line, sync_);
}

void RunDirectory::begin_attempt(const std::string& build, bool forced) {
  Row row;
  row.add("host", host_name());
  row.add("pid", std::int64_t{::getpid()});
  row.add("build", build);
  row.add("forced", forced);
  record_.add_attempt(row);
}

void RunDirectory::set_up(bool announce, const Tree& models) {
  announce_ = announce;
  record_.add_setup(announce, models, sync_);
  // If the directory entry of the record is not on the disk, the lines on the disk are lost.
  if (sync_) record_.sync_name();
}

std::vector<TapRecord> RunDirectory::recover() {
  const RunRecord& before = record_.before();
  rows_ = before.taps;
  for (const TapTimes& tap : before.timings) {
    for (std::size_t i = 0; i < kPhases; ++i) total_[i] += tap.seconds[i];
  }
  if (before.intent) rows_.push_back(unknown_result_of(*before.intent));
  std::vector<TapRecord> out = read_taps(rows_, before.file);
  if (before.intent) record_.add_tap(rows_.back(), true);
  return out;
}

void RunDirectory::announce(const TapRecord& tap) {
  check_in_place();
  if (announce_) record_.add_tap(intent_row(tap), sync_);
}

void RunDirectory::record(const TapRecord& tap, const std::array<double, kPhases>& seconds) {
  Row row = tap_row(tap);
  record_.add_tap(row, sync_);
  rows_.push_back(std::move(row));
  record_.add_timing({tap.number(), seconds, tap.shown_expected_rmse});
  for (std::size_t i = 0; i < kPhases; ++i) total_[i] += seconds[i];
}

void RunDirectory::note_learnt(const std::string& name, const std::string& value) {
  Row note;
  note.add("name", name);
  note.add("value", value);
  record_.add_note("learnt", note, sync_);
}

void RunDirectory::write_made(const std::string& name, const std::string& text) {
  write(name, text);
  made_.push_back({name, text.size(), hash_of(text)});
}

void RunDirectory::end(Ending ending) {
  for (Ending::ListedFile& one : std::exchange(made_, {})) ending.files.push_back(std::move(one));
  record_.add_end(ending, sync_);
  if (!ending.summary.fields.empty()) write(kSummaryFile, to_json(ending.summary));
}

void RunDirectory::fail(const std::string& reason) {
  const std::string id = fs::absolute(path_).lexically_normal().filename().string();
  // A damaged record gets only the line `end`. This suffices, because the state of a run is read from the last line.
  const bool damaged = catch_error([&] { before(); }).has_value();
  if (!damaged && !record_.begun())
    begin(Tree::map({{"id", Tree::quote(id)}, {"at", Tree::quote(now_text())}, {"version", Tree::quote(kVersion)}}));
  if (!damaged && record_.ended()) begin_attempt({}, false);
  Row row;
  row.add("id", id);
  row.add("status", "failed");
  row.add("stop_reason", reason);
  end({Ending::EndKind::failed, reason, row, {}});
}

}  // namespace palpate
