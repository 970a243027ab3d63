// SPDX-License-Identifier: MIT
#include "record/recording.hpp"

#include "config/catch_error.hpp"
#include "record/fields.hpp"
#include "record/record_reader.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// In the place of a backend: knows whether the scene was the truth, and makes no tap. What the run's own backend
/// reached is in the record.
class Absent : public Backend {
 public:
  explicit Absent(bool truth_known) : truth_known_(truth_known) {}
  Contact tap(const TapRequest&) override {
    throw Error("", "a recorded run makes no taps", {}, Error::Kind::run);  // would be a mistake in this program
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return truth_known_; }
  bool reaches(const Approach&) const override { return true; }

 private:
  bool truth_known_;
};

/// Reads what the run's own backend read. The taps are those of the record, whatever the target: a target that differs
/// shows.
class Recorded final : public Absent {
 public:
  Recorded(const Recording& recording, bool truth_known) : Absent(truth_known), recording_(recording) {}
  Quantities expects() const override {
    Quantities out;
    if (recording_.rows.front().number("predicted.height")) out = out | Quantity::height;
    if (recording_.rows.front().number("predicted.probability")) out = out | Quantity::probability;
    return out;
  }
  /// What the run's own backend read when it was shown the first tap is in the second row, with what others read there.
  Quantities reads() const override {
    return recording_.rows.size() > 1 ? recorded_quantities(recording_.rows[1]) : Quantities();
  }

 private:
  const Recording& recording_;
};

/// Has an experiment from any side choose among the lines that the record tells of, for the taps from `first` to
/// `last`, as far as they are recorded.
void recall_lines(Experiment& experiment, const Recording& recording, int first, int last) {
  auto* const any_side = dynamic_cast<FromAnySide*>(&experiment);
  if (any_side == nullptr) return;
  for (int i = first; i <= std::min(last, static_cast<int>(recording.taps.size())); ++i)
    any_side->recall(i, recording.taps[static_cast<std::size_t>(i - 1)].unreached);
}

class Collector final : public Journal {
 public:
  std::vector<Row> rows;
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { rows.push_back(tap_row(tap)); }
};

/// A recorded choice and all about its score.
TapRecord choice_of(const Recording& recording, std::size_t index, const Experiment& experiment) {
  const Row& row = recording.rows[index];
  const PastTap& past = recording.taps[index];
  TapRecord tap;
  tap.source = past.source;
  tap.why = past.why;
  tap.approach = past.approach;  // of which the candidate is found among the lines that are drawn for the tap
  if (const auto* const above = dynamic_cast<const FromAbove*>(&experiment))
    tap.candidate = above->candidates().nearest(past.target.x, past.target.y, experiment.scene().area());
  tap.score = row.number("score");
  if (const auto ties = row.number("ties")) tap.ties = static_cast<int>(*ties);
  if (const auto x = row.number("runner_up.x")) tap.runner_up = Target{*x, row.number("runner_up.y").value_or(0.0)};
  tap.runner_up_score = row.number("runner_up.score");
  return tap;
}

/// Has the experiment choose tap `number` as the record has it, where its strategy cannot be asked again.
void recall_choice(Experiment& experiment, const Recording& recording, int number) {
  if (!recording.scored_by_program()) return;
  const auto index = static_cast<std::size_t>(number - 1);
  const bool known = index < recording.rows.size();
  experiment.recall(known ? std::optional(choice_of(recording, index, experiment)) : std::nullopt);
}

std::string shown(const Scalar* value) {
  if (value == nullptr || std::holds_alternative<std::monostate>(*value)) return "null";
  return csv_cell(*value);
}

/// An experiment with the options of a recorded run, for its taps to be taken in again; `backend` makes what stands in
/// for its backend. `truth_lost` as of Playback.
template <class MakeBackend>
std::unique_ptr<Experiment> experiment_of(const Workshop& workshop, const Recording& recording,
                                          ExperimentOptions options, std::optional<Error>& truth_lost,
                                          const MakeBackend& backend) {
  std::unique_ptr<Experiment> out;
  const auto make = [&](bool truth) {
    return catch_error([&] { out = make_experiment(options, workshop.host, workshop.interrupted, backend(truth)); });
  };
  const bool truth_known = recording.truth_known();
  const std::optional<Error> trouble = make(truth_known);
  if (!trouble) return out;
  options.scene.objects.clear();
  if (make(false)) throw Error(*trouble);  // which the objects are not to blame for
  if (truth_known) truth_lost = trouble;
  return out;
}

void compare(const Row& recorded, const Row& replayed, int tap, ReplayReport& report) {
  const auto left_out = [&](const std::string& field) {
    return depends_on_machine(field) || (report.truth_lost && needs_truth(field));
  };
  for (const auto& [field, value] : recorded.fields) {
    if (left_out(field) || replayed.find(field) != nullptr) continue;
    ++report.numbers;
    report.differences.push_back({tap, field, shown(&value), "nothing"});
  }
  for (const auto& [field, value] : replayed.fields) {
    if (left_out(field)) continue;
    ++report.numbers;
    const std::string before = shown(recorded.find(field));
    const std::string now = shown(&value);
    if (before != now) report.differences.push_back({tap, field, before, now});
  }
}

using Seconds = std::array<double, kPhases>;

/// The seconds by phase up to each tap, before the first one included.
std::vector<Seconds> seconds_until(const Recording& recording) {
  std::vector<Seconds> out(1);
  for (const TapTimes& tap : recording.timings) {
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

std::shared_ptr<Backend> no_backend(bool truth_known) { return std::make_shared<Absent>(truth_known); }

Quantities recorded_quantities(const Row& row) {
  const auto has = [&](const char* field) { return row.number(field).has_value(); };
  Quantities out;
  if (has("height_gp.signal")) out = out | Quantity::uncertainty;
  if (has("label_gp.signal")) out = out | Quantity::weight;
  if (has("surface_gp.signal")) out = out | Quantity::height;
  // A summary has no p.
  if (has("p") || row.find("footprint.remark") != nullptr) out = out | Quantity::probability;
  return out;
}

bool Recording::truth_known() const { return rows.front().flag("true_on_object").has_value(); }

bool Recording::scored_by_program() const { return config.notes.plugins.count({"acquisition", "program"}) != 0; }

bool Recording::failed() const { return summary && summary->text("status") == "failed"; }

Recording read_recording(const Workshop& workshop, const fs::path& directory) {
  ResolvedConfig config = load_run(workshop.host, directory);
  RunRecord record = read_run_record(directory);
  if (record.taps.empty()) throw Error(directory.string(), "has no recorded tap", {}, Error::Kind::run);
  Recording out{directory, std::move(config),         std::move(record.taps),
                {},        std::move(record.timings), std::move(record.manifest),
                {}};
  out.taps = past_taps(out.rows, record.file);
  if (record.end && record.end->how != Ending::How::interrupted) out.summary = std::move(record.end->summary);
  return out;
}

Playback::Playback(const Workshop& workshop, const Recording& recording)
    : recording_(recording),
      experiment_(experiment_of(workshop, recording, recording.config.options, truth_lost_, no_backend)) {
  recall_choice(*experiment_, recording_, 1);
}

void Playback::advance_to(int taps) {
  recall_lines(*experiment_, recording_, taps_ + 1, taps + 1);
  const auto begin = recording_.taps.begin();
  experiment_->resume({begin + taps_, begin + taps});
  taps_ = taps;
  recall_choice(*experiment_, recording_, taps + 1);
}

RunResult Playback::result() {
  RunResult out = experiment_->result();
  if (!truth_lost_) return out;
  // A row has the errors of the state that its tap was chosen from.
  const auto next = static_cast<std::size_t>(taps_);
  const Row none;
  out.errors = errors_in(next < recording_.rows.size() ? recording_.rows[next] : recording_.summary.value_or(none));
  return out;
}

ReplayReport replay_run(const Workshop& workshop, const fs::path& directory) {
  const Recording recording = read_recording(workshop, directory);
  const std::vector<Row>& recorded = recording.rows;
  const auto made = static_cast<int>(recorded.size());
  const bool cut = made < recording.config.options.taps;
  // A run that ended by this rule failed by its arm: here its taps are compared like any other's.
  ExperimentOptions options = recording.config.options;
  options.stop.failed_in_a_row.reset();
  ReplayReport report;
  const std::unique_ptr<Experiment> made_again =
      experiment_of(workshop, recording, options, report.truth_lost,
                    [&](bool truth_known) { return std::make_shared<Recorded>(recording, truth_known); });
  Experiment& experiment = *made_again;
  recall_lines(experiment, recording, 1, made);
  const bool from_above = dynamic_cast<const FromAbove*>(made_again.get()) != nullptr;
  Collector collector;
  for (std::size_t i = 0;; ++i) {
    std::optional<Wish> wish;  // what somebody had chosen by scores of their own
    if (from_above && i < recorded.size() && recording.taps[i].of_caller())
      wish = Wish{{}, choice_of(recording, i, experiment)};
    recall_choice(experiment, recording, static_cast<int>(i) + 1);
    std::optional<TapRecord> tap = experiment.begin(collector, made, wish ? &*wish : nullptr);
    if (!tap) break;
    tap->contact = recording.taps.at(i).contact;
    experiment.end(*tap, collector);
  }

  report.taps = made;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    if (i < collector.rows.size()) {
      compare(recorded[i], collector.rows[i], number, report);
    } else {
      report.differences.push_back({number, "tap", "made", "not made"});
    }
  }
  if (!recording.summary) return report;
  const Row& summary = *recording.summary;
  // A run that found no further candidate had looked for one, which this one is not asked for.
  experiment.ask(recorded_quantities(summary));
  // A failed run asks its models nothing any more: see carry_out().
  const bool failed = recording.failed();
  RunResult result = failed ? experiment.counts() : experiment.result();
  // A record that failed, or ended before its budget, did so for a reason that the taps alone do not show.
  if (failed || cut) result.stop_reason = summary.text("stop_reason");
  const std::string failure = failed ? result.stop_reason : std::string();
  compare(summary, summary_list().row({result, recording.config, failure, {}, {}, {}, {}}), 0, report);
  return report;
}

std::vector<Row> earlier_summaries(const Workshop& workshop, const Recording& recording) {
  const std::vector<Seconds> seconds = seconds_until(recording);
  // A kill may have lost lines of the times, which no run depends on.
  const bool timed = seconds.size() == recording.taps.size() + 1;
  const double all = total(seconds.back());
  Playback playback(workshop, recording);
  if (playback.truth_lost()) throw Error(*playback.truth_lost());
  std::vector<Row> out;
  for (std::size_t count = 1; count < recording.rows.size(); ++count) {
    playback.advance_to(static_cast<int>(count));
    playback.experiment().ask(asked_after(recording, count));
    RunResult result = playback.experiment().result();
    result.stop_reason = "tap budget";
    const std::optional<Seconds> until = timed ? std::optional(seconds[count]) : std::nullopt;
    const auto part = [&](const char* whole) {
      const auto of_run = recording.summary ? recording.summary->number(whole) : std::nullopt;
      return of_run && until && all > 0.0 ? std::optional(*of_run * total(*until) / all) : std::nullopt;
    };
    out.push_back(
        summary_list().row({result, recording.config, "", part("wall_seconds"), part("compute_seconds"), until, {}}));
  }
  return out;
}

}  // namespace palpate
