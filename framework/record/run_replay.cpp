// SPDX-License-Identifier: MIT
#include "record/run_replay.hpp"

#include "config/catch_error.hpp"
#include "experiment/unreached.hpp"
#include "record/fields.hpp"

#include <array>
#include <numeric>

namespace palpate {

/// Replaces the backend of a recorded run. This backend reads the same quantities and rejects the same lines as the
/// original backend, and makes no taps.
class RecordedBackend final : public Backend {
 public:
  /// `run` is null if there is no record.
  RecordedBackend(const RecordedRun* run, bool truth_known) : run_(run), truth_known_(truth_known) {}

  /// Sets the tap, counted from 1, to which the next lines belong.
  void set_tap(int tap) {
    tap_ = tap;
    tries_ = 0;
  }

  TapResult tap(const TapRequest&) override {
    throw Error("", "a recorded run makes no taps", {}, Error::Kind::run);  // a programming error
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return truth_known_; }
  bool taps_any_line() const override { return true; }

  void reaches(const Candidates& lines, BoolOut out) const override {
    const auto index = static_cast<std::size_t>(tap_ - 1);
    const bool is_known = run_ != nullptr && index < run_->taps.size();
    for (Eigen::Index i = 0; i < lines.size(); ++i, ++tries_)
      out(i) = !is_known || !is_unreached(run_->taps[index].unreached, tries_);
  }

  QuantitySet predicts() const override {
    QuantitySet out;
    if (has("predicted.height")) out = {quantity::kHeightMean, quantity::kHeightStd};
    if (has("predicted.probability")) out.insert(quantity::kObjectProbability);
    return out;
  }

  /// Returns the quantities whose models appear in the first row. The original run read these quantities before its
  /// first tap.
  QuantitySet reads() const override {
    QuantitySet out;
    if (has("height_gp.signal")) out.insert(quantity::kUncertainty);
    if (has("label_gp.signal")) out.insert(quantity::kLabelMean);
    if (has("surface_gp.signal")) out.insert(quantity::kHeightMean);
    if (has("p")) out.insert(quantity::kObjectProbability);
    return out;
  }

 private:
  bool has(const char* field) const { return run_ != nullptr && run_->rows.front().number(field).has_value(); }

  const RecordedRun* run_;
  bool truth_known_;
  int tap_ = 1;
  mutable std::size_t tries_ = 0;  ///< number of lines tested for this tap so far
};

namespace {

/// Collects the rows of replayed taps.
class Collector final : public Observer {
 public:
  std::vector<Row> rows;
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { rows.push_back(tap_row(tap)); }
};

std::string shown(const Scalar* value) {
  if (value == nullptr || std::holds_alternative<std::monostate>(*value)) return "null";
  return csv_cell(*value);
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

/// Returns the sums of the seconds per phase up to each tap; the first entry is before the first tap.
std::vector<Seconds> seconds_until(const RecordedRun& run) {
  std::vector<Seconds> out(1);
  for (const TapTimes& tap : run.timings) {
    Seconds sum = out.back();
    for (std::size_t i = 0; i < kPhases; ++i) sum[i] += tap.seconds[i];
    out.push_back(sum);
  }
  return out;
}

double total(const Seconds& seconds) { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

}  // namespace

std::shared_ptr<Backend> no_backend(bool truth_known) {
  return std::make_shared<RecordedBackend>(nullptr, truth_known);
}

ReadPlan readers_from_first_tap(const std::string& name, const QuantitySet& quantities, bool is_optional) {
  return {{{name, quantities, Stage::first_tap, false, is_optional}}, Stage::first_tap};
}

RunReplay::RunReplay(const RunEnvironment& environment, const RecordedRun& run, const ReadPlan& readers) : run_(run) {
  ExperimentOptions options = run.config.options;
  // This stop rule ends a run after several failed taps in a row. It is removed, because the replay must process all
  // taps.
  options.stop.failed_in_a_row.reset();
  const auto make = [&](bool truth_known) {
    return catch_error([&] {
      backend_ = std::make_shared<RecordedBackend>(&run, truth_known);
      experiment_ = std::make_unique<Experiment>(
          options, ExperimentSetup{environment.host, environment.interrupted, backend_, {}, readers});
    });
  };
  const std::optional<Error> trouble = make(run.truth_known());
  if (!trouble) return;
  options.scene.objects.clear();
  if (make(false)) throw Error(*trouble);  // the error occurs without the objects, too
  if (run.truth_known()) truth_lost_ = trouble;
}

RunReplay::~RunReplay() = default;

void RunReplay::advance_to(int taps) {
  for (; taps_ < taps; ++taps_) {
    backend_->set_tap(taps_ + 1);
    experiment_->resume({run_.taps[static_cast<std::size_t>(taps_)]});
  }
  backend_->set_tap(taps_ + 1);
}

std::optional<TapOverride> RunReplay::recorded_choice(int tap) const {
  const auto index = static_cast<std::size_t>(tap - 1);
  if (index >= run_.taps.size()) return std::nullopt;
  const TapRecord& choice = run_.taps[index];
  const bool is_asked =
      choice.request.source == Source::initial || (!run_.scored_by_program() && !choice.is_of_caller());
  return is_asked ? std::nullopt : std::optional(TapOverride{{}, choice});
}

std::optional<TapRecord> RunReplay::next() {
  const std::optional<TapOverride> choice = recorded_choice(taps_ + 1);
  const bool is_last = static_cast<std::size_t>(taps_) >= run_.taps.size();
  if (is_last && run_.scored_by_program()) return std::nullopt;
  return experiment_->choose_next(choice ? &*choice : nullptr);
}

bool RunReplay::run_next(Observer& observer) {
  const std::optional<TapOverride> choice = recorded_choice(taps_ + 1);
  std::optional<TapRecord> tap =
      experiment_->begin(observer, static_cast<int>(run_.taps.size()), choice ? &*choice : nullptr);
  if (!tap) return false;
  tap->result = run_.taps[static_cast<std::size_t>(taps_)].result;
  experiment_->end(*tap, observer);
  backend_->set_tap(++taps_ + 1);
  return true;
}

RunResult RunReplay::result() {
  RunResult out = experiment_->result();
  if (!truth_lost_) return out;
  // The row of a tap contains the errors of the state before this tap.
  const auto next = static_cast<std::size_t>(taps_);
  const Row none;
  out.errors = errors_in(next < run_.rows.size() ? run_.rows[next] : run_.summary.value_or(none));
  return out;
}

ReplayReport replay_run(const RunEnvironment& environment, const RecordedRun& run) {
  const auto made = static_cast<int>(run.rows.size());
  RunReplay replay(environment, run);
  Experiment& experiment = replay.experiment();
  ReplayReport report;
  report.truth_lost = replay.truth_lost();
  report.taps = made;
  Collector replayed;
  while (replay.run_next(replayed)) {
  }
  for (std::size_t i = 0; i < run.rows.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    if (i < replayed.rows.size()) {
      compare(run.rows[i], replayed.rows[i], number, report);
    } else {
      report.differences.push_back({number, "tap", "made", "not made"});
    }
  }
  if (!run.summary) return report;
  const Row& summary = *run.summary;
  const std::string reason = summary.text("stop_reason");
  // A run that did not fail updated its models once more after the last tap, for its stop rules or to search for a
  // candidate.
  if (!run.failed()) experiment.reason_to_stop();
  // A failed run does not read its models again: see Run::end().
  RunResult result = run.failed() ? experiment.counts() : experiment.result();
  // The taps alone do not contain the reason why a run failed or ended before its budget.
  if (run.failed() || made < run.config.options.taps) result.stop_reason = reason;
  compare(summary, summary_list().row({result, run.config, run.failed() ? reason : "", {}, {}, {}, {}}), 0, report);
  return report;
}

std::vector<Row> earlier_summaries(const RunEnvironment& environment, const RecordedRun& run) {
  const std::vector<Seconds> seconds = seconds_until(run);
  // Lines `timing` may be missing after a kill. The results of runs do not depend on them.
  const bool timed = seconds.size() == run.taps.size() + 1;
  const double all = total(seconds.back());
  RunReplay replay(environment, run);
  if (replay.truth_lost()) throw Error(*replay.truth_lost());
  std::vector<Row> out;
  for (std::size_t count = 1; count < run.rows.size(); ++count) {
    replay.advance_to(static_cast<int>(count));
    RunResult result = replay.experiment().result();
    result.stop_reason = "tap budget";
    const std::optional<Seconds> until = timed ? std::optional(seconds[count]) : std::nullopt;
    const auto part = [&](const char* whole) {
      const auto of_run = run.summary ? run.summary->number(whole) : std::nullopt;
      return of_run && until && all > 0.0 ? std::optional(*of_run * total(*until) / all) : std::nullopt;
    };
    out.push_back(
        summary_list().row({result, run.config, "", part("wall_seconds"), part("compute_seconds"), until, {}}));
  }
  return out;
}

}  // namespace palpate
