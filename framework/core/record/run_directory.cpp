// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "config/trouble.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTaps = "taps.jsonl";
constexpr const char* kTimings = "timings.csv";
constexpr const char* kSummary = "summary.json";
constexpr const char* kLock = "lock";

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
    out.emplace().add("status", "failed");
    out->add("stop_reason", trouble->what());
  }
  return out;
}

void check_complete(const Row& summary, int recorded, const fs::path& directory) {
  const std::optional<double> made = summary.number("taps");
  if (summary.text("status") != "done" || !made || *made <= recorded) return;
  throw Error((directory / kTaps).string(), fmt::format("holds {} of the {} taps that were made", recorded, *made),
              "the file was cut: put it back, or remove summary.json, and 'palpate resume' makes the others again");
}

RunStatus read_ending(const fs::path& directory) {
  RunStatus out;
  if (const std::optional<Row> summary = read_outcome(directory)) {
    out.state = summary->text("status") == "done" ? RunStatus::State::done : RunStatus::State::failed;
    out.stop_reason = summary->text("stop_reason");
  } else if (is_there(directory / kTaps)) {
    out.state = RunStatus::State::unfinished;
  }
  return out;
}

bool is_running(const fs::path& directory) { return FileLock::is_held(directory / kLock); }

RunStatus read_record(const fs::path& directory) {
  RunStatus out = read_ending(directory);
  if (is_there(directory / kTaps)) {
    for (const Row& row : read_json_lines(directory / kTaps).rows) out.taps += is_intent(row) ? 0 : 1;
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

RunDirectory::RunDirectory(const fs::path& directory) : path_(make_folder(directory)), lock_(path_ / kLock) {
  remove_neighbours(path_, {"config.yaml", "manifest.json", "taps.csv", "surface.csv", "objects.csv", kSummary});
  remove_neighbours(path_ / "maps", {});
}

void RunDirectory::check_in_place() const {
  if (taps_.is_in_place()) return;
  throw Error(path_.string(), "was moved or removed while a run was writing there",
              "where it was moved to, 'palpate resume' carries on", Error::Kind::run);
}

std::vector<PastTap> RunDirectory::recover() {
  if (!is_there(path_ / kTaps)) return {};
  JsonLines lines = read_json_lines(path_ / kTaps);
  cut_file(path_ / kTaps, lines.bytes);
  std::optional<Row> intent;
  for (Row& row : lines.rows) {
    if (is_intent(row)) {
      intent = std::move(row);
      continue;
    }
    intent.reset();
    rows_.push_back(std::move(row));
  }
  if (intent) {
    rows_.push_back(unknown_result_of(*intent));
    AppendFile(path_ / kTaps).append(to_json_line(rows_.back()) + "\n", true);
  }
  if (is_there(path_ / kTimings)) cut_file(path_ / kTimings, read_file(path_ / kTimings).rfind('\n') + 1);
  for (const TapTimes& tap : read_timings(path_).taps) {
    for (std::size_t i = 0; i < kPhases; ++i) total_[i] += tap.seconds[i];
  }
  return past_taps(rows_, path_ / kTaps);
}

void RunDirectory::open(bool announce, bool sync) {
  announce_ = announce;
  sync_ = sync;
  taps_ = AppendFile(path_ / kTaps);
  std::error_code none;
  const bool fresh = !is_there(path_ / kTimings) || fs::file_size(path_ / kTimings, none) == 0;
  timings_ = AppendFile(path_ / kTimings);
  if (!fresh) return;
  std::string header;
  for (const RecordField& field : timing_list().fields()) header += (header.empty() ? "" : ",") + field.name;
  timings_.append(header + "\n", false);
}

void RunDirectory::announce(const TapRecord& tap) {
  check_in_place();
  if (announce_) taps_.append(to_json_line(intent_row(tap)) + "\n", sync_);
}

void RunDirectory::record(const TapRecord& tap, const std::array<double, kPhases>& seconds) {
  rows_.push_back(tap_row(tap));
  taps_.append(to_json_line(rows_.back()) + "\n", sync_);
  std::string line = std::to_string(tap.number);
  for (std::size_t i = 0; i < kPhases; ++i) {
    line += fmt::format(",{:.9f}", seconds[i]);
    total_[i] += seconds[i];
  }
  timings_.append(line + "\n", false);
}

}  // namespace palpate
