// SPDX-License-Identifier: MIT
#include "record/earlier.hpp"

#include "record/files.hpp"
#include "record/summary.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>

namespace palpate {
namespace {

using Seconds = std::array<double, kPhases>;

/// Of timings.csv: the seconds by phase up to each tap, before the first one included.
std::vector<Seconds> seconds_until(const std::filesystem::path& directory) {
  std::vector<Seconds> out(1);
  std::istringstream lines(read_file(directory / "timings.csv"));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    Seconds sum = out.back();
    const char* at = line.data() + std::min(line.find(','), line.size());
    const char* const end = line.data() + line.size();
    for (std::size_t i = 0; i < kPhases && at < end; ++i) {
      double seconds = 0.0;
      at = std::from_chars(at + 1, end, seconds).ptr;
      sum[i] += seconds;
    }
    out.push_back(sum);
  }
  return out;
}

double total(const Seconds& seconds) { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

void set(Row& row, const std::string& name, Scalar value) {
  for (auto& [field, old] : row.fields) {
    if (field == name) old = std::move(value);
  }
}

/// What had been asked for in a run of that budget when it ended: after its last tap its backend was shown the belief,
/// which the row of the next tap tells of, unless the strategy has read for that one.
Quantities asked_after(const Recording& recording, std::size_t taps) {
  const bool next = taps < recording.rows.size() && recording.taps[taps].source == Source::initial;
  return recorded_quantities(recording.rows[next ? taps : taps - 1]);
}

/// The share of a time of the whole run.
Scalar share_of(const std::optional<Row>& summary, const char* name, const std::optional<double>& share) {
  const Scalar* whole = summary ? summary->find(name) : nullptr;
  if (whole == nullptr || !share) return std::monostate{};
  if (const auto* seconds = std::get_if<double>(whole)) return *seconds * *share;
  return std::monostate{};
}

}  // namespace

std::vector<Row> summaries_after(const Workshop& workshop, const Recording& recording, const std::vector<int>& taps) {
  if (!taps.empty() && static_cast<std::size_t>(*std::max_element(taps.begin(), taps.end())) > recording.rows.size()) {
    throw Error(recording.directory.string(), "its taps.jsonl holds fewer taps than its summary says",
                "the file is damaged, run the job again");
  }
  const std::vector<Seconds> seconds = seconds_until(recording.directory);
  Playback playback(workshop, recording);
  std::vector<Row> rows;
  for (const int count : taps) {
    playback.advance_to(count);
    if (count > 0) playback.experiment().ask(asked_after(recording, static_cast<std::size_t>(count)));
    RunResult result = playback.experiment().result();
    result.stop_reason = "tap budget";
    // A kill may have lost lines of the times, which no run depends on.
    const bool timed = seconds.size() == recording.taps.size() + 1;
    const Seconds until = timed ? seconds[static_cast<std::size_t>(count)] : Seconds{};
    const double all = total(seconds.back());
    const std::optional<double> share = timed && all > 0.0 ? std::optional(total(until) / all) : std::nullopt;
    Row row = summary_row(recording.config, result, "", Stopwatch{}, until);
    for (const char* whole : {"wall_seconds", "compute_seconds"})
      set(row, whole, share_of(recording.summary, whole, share));
    if (!timed) {
      for (const char* phase : kPhaseNames) set(row, std::string("compute.") + phase, std::monostate{});
    }
    set(row, "peak_rss_bytes", std::monostate{});
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace palpate
