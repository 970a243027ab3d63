// SPDX-License-Identifier: MIT
#include "record/run_directory.hpp"

#include "record/json.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <charconv>
#include <sstream>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTaps = "taps.jsonl";
constexpr const char* kTimings = "timings.csv";
constexpr const char* kSummary = "summary.json";
constexpr const char* kLock = "lock";

std::string text_at(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  const auto* text = value != nullptr ? std::get_if<std::string>(value) : nullptr;
  return text != nullptr ? *text : std::string();
}

fs::path made(fs::path directory) {
  std::error_code trouble;
  fs::create_directories(directory, trouble);
  if (trouble) throw Error(directory.string(), "cannot be made: " + trouble.message(), {}, Error::Kind::run);
  return directory;
}

}  // namespace

const char* state_name(RunStatus::State state) {
  constexpr std::array<const char*, 5> kNames{"missing", "running", "unfinished", "done", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

RunStatus read_ending(const fs::path& directory) {
  RunStatus out;
  std::error_code none;
  if (fs::exists(directory / kSummary, none)) {
    const std::optional<Row> summary = parse_json_row(read_file(directory / kSummary));
    if (!summary) {
      // As a power cut leaves it: the name is there and the content was never written.
      throw Error((directory / kSummary).string(), "is not a JSON object",
                  "the file is damaged: remove it, and 'palpate resume' makes it anew from the taps");
    }
    out.state = text_at(*summary, "status") == "done" ? RunStatus::State::done : RunStatus::State::failed;
    out.stop_reason = text_at(*summary, "stop_reason");
  } else if (fs::exists(directory / kTaps, none)) {
    out.state = RunStatus::State::unfinished;
  }
  return out;
}

bool is_running(const fs::path& directory) { return FileLock::is_held(directory / kLock); }

RunStatus read_record(const fs::path& directory) {
  RunStatus out = read_ending(directory);
  std::error_code none;
  if (fs::exists(directory / kTaps, none)) {
    for (const Row& row : read_json_lines(directory / kTaps).rows) out.taps += is_intent(row) ? 0 : 1;
  }
  return out;
}

RunStatus read_status(const fs::path& directory) {
  // Asked first: who ends between the two questions has written what the second one reads.
  const bool held = is_running(directory);
  RunStatus out = read_record(directory);
  if (held && out.state != RunStatus::State::done) out.state = RunStatus::State::running;
  return out;
}

RunDirectory::RunDirectory(fs::path directory) : path_(made(std::move(directory))), lock_(path_ / kLock) {}

std::vector<PastTap> RunDirectory::recover() {
  std::error_code none;
  if (!fs::exists(path_ / kTaps, none)) return {};
  JsonLines lines = read_json_lines(path_ / kTaps);
  fs::resize_file(path_ / kTaps, lines.bytes);
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
  recover_timings();
  std::vector<PastTap> past;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    past.push_back(past_tap(rows_[i], fmt::format("{}: tap {}", (path_ / kTaps).string(), i + 1)));
  }
  return past;
}

void RunDirectory::recover_timings() {
  std::error_code none;
  if (!fs::exists(path_ / kTimings, none)) return;
  const std::string text = read_file(path_ / kTimings);
  fs::resize_file(path_ / kTimings, text.rfind('\n') + 1);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const char* at = line.data() + std::min(line.find(','), line.size());
    const char* end = line.data() + line.size();
    for (std::size_t i = 0; i < kPhases && at < end; ++i) {
      double seconds = 0.0;
      at = std::from_chars(at + 1, end, seconds).ptr;
      total_[i] += seconds;
    }
  }
}

void RunDirectory::open(bool announce, bool sync) {
  announce_ = announce;
  sync_ = sync;
  taps_ = AppendFile(path_ / kTaps);
  std::error_code none;
  const bool fresh = !fs::exists(path_ / kTimings, none) || fs::file_size(path_ / kTimings, none) == 0;
  timings_ = AppendFile(path_ / kTimings);
  if (!fresh) return;
  std::string header = "tap";
  for (const char* name : kPhaseNames) header += std::string(",") + name;
  timings_.append(header + "\n", false);
}

void RunDirectory::announce(const TapRecord& tap) {
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
