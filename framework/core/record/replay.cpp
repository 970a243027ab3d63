// SPDX-License-Identifier: MIT
// Replay: the recorded contacts go through the same models, and every number is compared as text, bit for bit.
#include "experiment/experiment.hpp"
#include "record/fields.hpp"
#include "record/recording.hpp"
#include "record/summary.hpp"
#include "record/tap_row.hpp"

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Answers with the recorded contacts in their order, whatever the target: a target that differs shows in the record.
class Recorded final : public Backend {
 public:
  Recorded(const Recording& recording, bool predicted) : recording_(recording), predicted_(predicted) {}
  Contact tap(const TapRequest& request) override {
    return recording_.taps.at(static_cast<std::size_t>(request.number - 1)).contact;
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return recording_.truth_known(); }
  bool wants_prediction() const override { return predicted_; }
  /// What the run's own backend read when it was shown the first tap is in the second row, with what others read there.
  Quantities reads() const override {
    return recording_.rows.size() > 1 ? recorded_quantities(recording_.rows[1]) : Quantities();
  }

 private:
  const Recording& recording_;
  bool predicted_;
};

class Collector final : public Journal {
 public:
  std::vector<Row> rows;
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { rows.push_back(tap_row(tap)); }
};

std::string shown(const Scalar* value) {
  if (value == nullptr || std::holds_alternative<std::monostate>(*value)) return "null";
  return csv_cell(*value);
}

void compare(const Row& recorded, const Row& replayed, int tap, ReplayReport& report) {
  for (const auto& [field, value] : recorded.fields) {
    if (depends_on_machine(field) || replayed.find(field) != nullptr) continue;
    ++report.numbers;
    report.differences.push_back({tap, field, shown(&value), "nothing"});
  }
  for (const auto& [field, value] : replayed.fields) {
    if (depends_on_machine(field)) continue;
    ++report.numbers;
    const std::string before = shown(recorded.find(field));
    const std::string now = shown(&value);
    if (before != now) report.differences.push_back({tap, field, before, now});
  }
}

}  // namespace

ReplayReport replay_run(const Workshop& workshop, const fs::path& directory) {
  const Recording recording = read_recording(workshop, directory);
  const std::vector<Row>& recorded = recording.rows;
  const auto made = static_cast<int>(recorded.size());
  const bool cut = made < recording.config.options.taps;
  Experiment experiment(recording.config.options, workshop.host, workshop.interrupted,
                        std::make_shared<Recorded>(recording, recorded.front().number("predicted.height").has_value()));
  Collector collector;
  experiment.run(collector, made);

  ReplayReport report;
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

}  // namespace palpate
