// SPDX-License-Identifier: MIT
#include "watch/run_follower.hpp"

#include "config/catch_error.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/run.hpp"
#include "record/run_directory.hpp"
#include "report/page/page.hpp"
#include "report/page/run_page.hpp"

#include <fmt/format.h>

#include <chrono>
#include <regex>
#include <utility>

namespace palpate {

namespace {

/// Largest number of values in all stored maps. They take about 10 MB in a page, which every browser can hold.
constexpr std::size_t kMostNumbers = 4'000'000;

struct PagePosition {
  int generation = 0;
  int moments = 0;
  int revision = 0;
};

/// Parses a position of RunFollower::at(): three numbers. Returns zeros for any other text.
PagePosition parse_position(const std::string& at) {
  static const std::regex form("([0-9]{1,9})\\.([0-9]{1,9})\\.([0-9]{1,9})");
  std::smatch parts;
  if (!std::regex_match(at, parts, form)) return {};
  return {std::stoi(parts[1]), std::stoi(parts[2]), std::stoi(parts[3])};
}

}  // namespace

RunFollower::RunFollower(const RunEnvironment& environment, std::filesystem::path directory)
    : environment_(environment), directory_(std::move(directory)), log_(directory_ / kRecordFile) {}

bool RunFollower::goes_on() const { return is_running(directory_); }

void RunFollower::start_over() {
  builder_.reset();
  recording_.reset();
  pending_.clear();
  manifest_.reset();
  timings_.clear();
  trouble_.clear();
  ++generation_;
}

bool RunFollower::look(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  const std::optional<Error> trouble = catch_error([&] {
    read_record();
    while (!pending_.empty() && trouble_.empty()) {
      replay_next_tap();
      if (std::chrono::steady_clock::now() >= end) break;
    }
  });
  if (trouble && trouble_ != trouble->what()) {
    trouble_ = trouble->what();
    ++revision_;
  }
  return !pending_.empty() && trouble_.empty();
}

void RunFollower::read_record() {
  // The lock is checked before the record is read. If the process ends in between, the record then already contains all
  // its taps.
  const bool held = is_running(directory_);
  const std::optional<Row> summary = read_outcome(directory_);
  const std::string standing = (held ? "held " : "") + (summary ? to_json(*summary) : "");
  bool anew = false;
  std::vector<RecordLine> lines = log_.read(anew);
  // If the known lines could not be replayed, another record may have replaced this one, so it is read from the
  // beginning.
  if (!lines.empty() && !trouble_.empty()) {
    log_.restart();
    lines = log_.read(anew);
    anew = true;
  }
  if (anew) start_over();
  for (RecordLine& line : lines) {
    if (line.kind == LineKind::tap) pending_.push_back(std::move(line.row));
    if (line.kind == LineKind::timing) timings_.push_back(times_of(line.row));
    if (line.kind == LineKind::manifest) manifest_ = std::move(line.tree);
  }
  if (standing != standing_) {
    standing_ = standing;
    ++revision_;
  }
  if (recording_) add_times();
  if (recording_ && pending_.empty()) recording_->summary = summary;
}

/// Adds the times read since the last call. The times are added separately, because the record contains the times of a
/// tap after the tap itself.
void RunFollower::add_times() {
  std::vector<TapTimes>& known = recording_->timings;
  if (known.size() == timings_.size()) return;
  known.insert(known.end(), timings_.begin() + static_cast<std::ptrdiff_t>(known.size()), timings_.end());
  ++revision_;
}

void RunFollower::replay_next_tap() {
  if (!recording_)
    recording_ = std::make_unique<RecordedRun>(
        RecordedRun{directory_, load_run(environment_.host, directory_), {}, {}, {}, manifest_, {}});
  add_times();
  recording_->taps.push_back(read_taps({pending_.front()}, log_.file()).front());
  recording_->rows.push_back(std::move(pending_.front()));
  pending_.pop_front();
  if (!builder_) builder_ = std::make_unique<HistoryBuilder>(environment_, *recording_);
  const bool own_scores = builder_->has_own_scores();
  builder_->advance();
  builder_->thin(kMostNumbers);
  // Open pages lack the new map of scores and must reload.
  if (builder_->has_own_scores() != own_scores) ++generation_;
  if (pending_.empty()) recording_->summary = read_outcome(directory_);
}

std::string RunFollower::at() const {
  return fmt::format("{}.{}.{}", generation_, builder_ ? builder_->taps() + 1 : 0, revision_);
}

std::string RunFollower::waiting_reason() const {
  if (!trouble_.empty()) return trouble_;
  return "No tap is recorded yet. This page updates after the first tap.";
}

std::string RunFollower::page() {
  std::string out;
  if (builder_) {
    if (const auto trouble = catch_error([&] { out = live_run_page(*recording_, builder_->since(0), at()); }))
      trouble_ = trouble->what();
  }
  if (!out.empty()) return out;
  std::string name = "run";
  catch_error([&] {
    const Tree config = read_run_config(directory_);
    if (const Tree* said = config.find("name")) name = said->text;
  });
  return waiting_page(name, directory_.filename().string(), waiting_reason(), at());
}

std::optional<std::string> RunFollower::news(const std::string& at) {
  const PagePosition page = parse_position(at);
  const std::string now = this->at();
  if (now == at) return std::nullopt;
  const int moments = builder_ ? builder_->taps() + 1 : 0;
  const bool other = page.generation != generation_ || page.moments > moments || (page.moments == 0 && moments > 0);
  if (other) return line_of({{"at", now}, {"anew", true}});
  if (!trouble_.empty() || !builder_) return line_of({{"at", now}, {"trouble", waiting_reason()}});
  std::string out;
  const auto trouble =
      catch_error([&] { out = run_news(*recording_, builder_->since(page.moments), page.moments, now); });
  return trouble ? line_of({{"at", now}, {"trouble", trouble->what()}}) : out;
}

}  // namespace palpate
