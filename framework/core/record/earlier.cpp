// SPDX-License-Identifier: MIT
#include "record/earlier.hpp"

#include "record/fields.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

namespace palpate {
namespace {

using Seconds = std::array<double, kPhases>;

/// The seconds by phase up to each tap, before the first one included.
std::vector<Seconds> seconds_until(const std::filesystem::path& directory) {
  std::vector<Seconds> out(1);
  for (const TapTimes& tap : read_timings(directory).taps) {
    Seconds sum = out.back();
    for (std::size_t i = 0; i < kPhases; ++i) sum[i] += tap.seconds[i];
    out.push_back(sum);
  }
  return out;
}

double total(const Seconds& seconds) { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

/// What had been asked for in a run of that budget when it ended: after its last tap its backend was shown the belief,
/// which the row of the next tap tells of, unless the strategy has read for that one.
Quantities asked_after(const Recording& recording, std::size_t taps) {
  const bool next = taps < recording.rows.size() && recording.taps[taps].source == Source::initial;
  return recorded_quantities(recording.rows[next ? taps : taps - 1]);
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
    const auto part = [&](const char* whole) {
      const auto of_run = recording.summary ? recording.summary->number(whole) : std::nullopt;
      return of_run && share ? std::optional(*of_run * *share) : std::nullopt;
    };
    rows.push_back(summary_list().row({result,
                                       recording.config,
                                       "",
                                       part("wall_seconds"),
                                       part("compute_seconds"),
                                       timed ? std::optional(until) : std::nullopt,
                                       {}}));
  }
  return rows;
}

}  // namespace palpate
