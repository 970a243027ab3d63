// SPDX-License-Identifier: MIT
#include "report/page/warnings.hpp"

#include "record/fields.hpp"
#include "report/words/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

int diagnostics(const RunResult& result, const char* kind) {
  const auto found = result.state.diagnostics.find(kind);
  return found != result.state.diagnostics.end() ? found->second : 0;
}

/// Adds a text such as "3 taps", followed by `what`. Adds nothing if `count` is 0.
void add_counted(std::vector<std::string>& out, int count, const char* noun, const char* what) {
  if (count > 0) out.push_back(counted(count, noun) + what);
}

/// Returns whether two taps at the same position were made along different lines.
bool other_way(const TapLine& one, const TapLine& other) {
  if (one.from_above || other.from_above) return one.from_above != other.from_above;
  return one.start != other.start || one.direction != other.direction;
}

/// Returns the number of the first tap for which this build would have chosen another position or line; 0 if there is
/// no such tap.
int first_drift(const RecordedRun& recording, const History& history) {
  for (std::size_t i = 0; i < recording.taps.size(); ++i) {
    const std::optional<TapRecord>& next = history.moments[i].next;
    const TapRecord& made = recording.taps[i];
    if (!next || next->target().x != made.target().x || next->target().y != made.target().y ||
        other_way(next->request.line, made.request.line))
      return static_cast<int>(i) + 1;
  }
  return 0;
}

void warn_of_end(const RecordedRun& recording, const RunResult& last, std::vector<std::string>& out) {
  if (recording.failed()) {
    const std::string reason = recording.summary->text("stop_reason");
    out.push_back("The run failed" + (reason.empty() ? " without a reason." : ": " + reason));
  } else if (!recording.summary) {
    out.push_back(fmt::format("The run has not ended: this page shows its state after {}.", counted(last.taps, "tap")));
  }
  const bool any_side = recording.is_any_side();
  if (last.object_taps + last.desk_taps == 0) {
    out.push_back(any_side ? "No tap touched anything." : "No tap touched anything: the maps show the prior.");
  } else if (last.object_taps == 0) {
    out.push_back(any_side ? "No tap touched an object." : "No tap touched an object: the maps show where it is not.");
  }
  add_counted(out, last.failed_taps, "tap", " made no contact and did not reach the models.");
  add_counted(out, diagnostics(last, "heights_rejected"), "tap",
              any_side ? " rejected: the reported height is not a number, or the end is off the path."
                       : " rejected: the reported height is not a number.");
}

void warn_of_choices(const RecordedRun& recording, const History& history, std::vector<std::string>& out) {
  const bool any_side = recording.is_any_side();
  const RunResult& last = history.moments.back().result;
  if (const int fallbacks = diagnostics(last, "fallback"); fallbacks > 0)
    out.push_back(
        fmt::format("{} of {} {} chosen by the fallback, the largest uncertainty, because the acquisition's scores did "
                    "not distinguish the candidates (as before the first hit).",
                    fallbacks, counted(last.taps, "tap"), fallbacks == 1 ? "was" : "were"));
  const auto without_reason = [](const Row& row) {
    return row.text("source") == source_name(Source::acquisition) && row.number("score").value_or(1.0) <= 0.0;
  };
  if (const auto stalled = std::count_if(recording.rows.begin(), recording.rows.end(), without_reason); stalled > 0)
    out.push_back(
        fmt::format("{} chosen by the acquisition although no {} had a positive score: then the first one is taken.{}",
                    counted(stalled, "tap") + (stalled == 1 ? " was" : " were"), any_side ? "approach" : "candidate",
                    any_side ? "" : " Choose choice.fallback=uncertainty to search for the object instead."));
  if (const int drift = first_drift(recording, history); drift > 0)
    out.push_back(
        fmt::format("From the same earlier taps, this build would choose another position for tap {}: the run used "
                    "another build or instruction set. The {} show the recorded taps.",
                    drift, any_side ? "surfaces" : "maps"));
}

void warn_of_weights(const RecordedRun& recording, const History& history, std::vector<std::string>& out) {
  if (!history.moments.back().least_weight) return;
  const auto least =
      std::min_element(history.moments.begin(), history.moments.end(),
                       [](const RunAtTap& a, const RunAtTap& b) { return a.least_weight < b.least_weight; });
  const auto most =
      std::max_element(history.moments.begin(), history.moments.end(),
                       [](const RunAtTap& a, const RunAtTap& b) { return a.most_weight < b.most_weight; });
  constexpr double kRounding = 1e-6;
  if (*least->least_weight >= -kRounding && *most->most_weight <= 1.0 + kRounding) return;
  out.push_back(
      fmt::format("The weight leaves [0, 1]: from {:.2g} after tap {} to {:.2g} after tap {}. It is a regression on "
                  "labels, not a probability; {}.",
                  *least->least_weight, least->taps, *most->most_weight, most->taps,
                  belief_option(recording.config.options, "label.clip") == "true"
                      ? "the strategy uses it clipped (belief.label.clip)"
                      : "belief.label.clip=true would clip it for the strategy"));
}

void warn_of_numbers(const RunResult& last, std::vector<std::string>& out) {
  if (const int raised = diagnostics(last, "jitter"); raised > 0)
    out.push_back(
        fmt::format("Jitter up to {:.1e} was added to the covariance, {}: the taps made it singular in "
                    "double precision. It acts as noise of each tap.",
                    last.state.jitter_max, raised == 1 ? "once" : fmt::format("in {} steps", raised)));
  add_counted(out, diagnostics(last, "pivoted"), "factorisation", " needed pivoting as the last resort.");
  if (const int aside = diagnostics(last, "redundant_taps"); aside > 0)
    out.push_back(fmt::format("{} left out: to machine precision the other taps determine {}.",
                              counted(aside, "tap") + (aside == 1 ? " was" : " were"), aside == 1 ? "it" : "them"));
  if (const int clamped = diagnostics(last, "variance_clamped"); clamped > 0)
    out.push_back(fmt::format("Rounding took the variance of {} out of its bounds; the bounds are shown.",
                              counted(clamped, "candidate")));
  add_counted(out, diagnostics(last, "fit_failed"), "fit", " found no finite values and kept the old hyperparameters.");
}

}  // namespace

std::vector<std::string> warnings_of(const RecordedRun& recording, const History& history) {
  const RunResult& last = history.moments.back().result;
  std::vector<std::string> out;
  warn_of_end(recording, last, out);
  warn_of_choices(recording, history, out);
  if (const std::string remark = Row{last.state.fields}.text("footprint.remark"); !remark.empty())
    out.push_back(fmt::format("Remark of the footprint {}: {}.",
                              belief_option(recording.config.options, "footprint.type"), remark));
  warn_of_weights(recording, history, out);
  warn_of_numbers(last, out);
  if (history.truth_lost) out.push_back(truth_lost_words(*history.truth_lost) + ".");
  if (!recording.truth_known()) out.push_back("The truth is not known here: there are no errors to show.");
  return out;
}

}  // namespace palpate
