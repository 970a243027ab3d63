// SPDX-License-Identifier: MIT
// Records for Python: a run with its taps and models, and a sweep with its jobs.
#pragma once

#include "experiment/experiment.hpp"
#include "module_host.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "record/run_replay.hpp"
#include "record/surface_files.hpp"
#include "sweep/pooled_sweep.hpp"
#include "sweep/sweep.hpp"
#include "threads.hpp"
#include "values.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

using NamedMaps = std::vector<std::pair<const char*, Map>>;

/// Returns the maps that the belief currently offers, and the surface. Heights are in metres.
inline NamedMaps maps_of(Experiment& experiment) {
  experiment.look();
  Belief& belief = experiment.belief();
  const auto map = [&](const Eigen::VectorXd& values) {
    return Map{values, belief.candidates().rows, belief.candidates().columns};
  };
  NamedMaps out;
  const QuantitySet available = belief.available();
  for (const auto& [name, quantity] :
       {std::pair{"height_mean", quantity::kHeightMean}, std::pair{"height_standard_deviation", quantity::kHeightStd},
        std::pair{"uncertainty", quantity::kUncertainty}, std::pair{"weight", quantity::kLabelMean},
        std::pair{"probability", quantity::kObjectProbability}}) {
    if (available.count(quantity) != 0) out.emplace_back(name, map(belief.values(quantity)));
  }
  out.emplace_back("surface", map(belief.surface(kFineResolution).heights));
  return out;
}

/// The record of a run, and its models. Any thread that holds the GIL may call the methods. A lock ensures that only
/// one thread at a time uses the models.
class Record {
 public:
  explicit Record(const std::string& directory)
      : recording_(read_recorded_run(environment_.run_environment.host, directory)) {}
  /// In a forked child the models are never destroyed, because their destructor would wait for threads that do not
  /// exist in the child.
  ~Record() {
    if (!lock_.is_here()) static_cast<void>(playback_.release());
  }

  py::object config() const { return python_of(recording_.config.tree); }
  std::string id() const { return recording_.config.id; }
  std::vector<Column> taps() const { return columns_of(recording_.rows); }
  int size() const { return static_cast<int>(recording_.rows.size()); }
  /// Returns the manifest, or None if no manifest is recorded.
  py::object manifest() const {
    const std::optional<Tree>& manifest = recording_.manifest;
    return manifest ? py::module_::import("json").attr("loads")(to_json(*manifest)) : py::none();
  }
  /// Reads the summary file again and returns the summary. Returns None for a run that has not ended.
  py::object summary() const {
    const std::optional<Row> summary = read_summary(recording_.directory);
    return summary ? py::module_::import("json").attr("loads")(to_json_line(*summary)) : py::none();
  }
  bool is_here() const { return lock_.is_here(); }

  /// Returns the maps of the models after the first `taps` taps.
  NamedMaps after(int taps) {
    if (taps < 0 || taps > size())
      throw Error("after", "there are " + std::to_string(size()) + " taps, not " + std::to_string(taps), "take fewer");
    const ObjectGuard guard(lock_, "run");
    // After an exception, the models may contain a tap that RunReplay::taps() does not count. Therefore, the models are
    // moved out first, and stored again only after success.
    std::unique_ptr<RunReplay> models = std::move(playback_);
    if (!models || models->taps() > taps) models = make_replay();
    models->advance_to(taps);
    NamedMaps maps = maps_of(models->experiment());
    playback_ = std::move(models);
    return maps;
  }

  /// Returns the heights of the simulated scene in metres; nullopt if the taps were not made in a simulated scene.
  std::optional<Map> truth() {
    const ObjectGuard guard(lock_, "run");
    Experiment& experiment = playback().experiment();
    const Scene* const truth = experiment.truth();
    if (truth == nullptr) return std::nullopt;
    const Candidates& candidates = experiment.belief().candidates();
    return Map{true_heights(candidates, *truth), candidates.rows, candidates.columns};
  }

  std::pair<Eigen::VectorXd, Eigen::VectorXd> axes() {
    const ObjectGuard guard(lock_, "run");
    const CandidateGrid grid = grid_of(playback().experiment().belief().candidates());
    return {grid.xs, grid.ys};
  }

 private:
  std::unique_ptr<RunReplay> make_replay() const {
    using namespace quantity;
    if (recording_.is_any_side())
      throw Error(recording_.directory.string(), "is a run from any side, but this needs a run from above",
                  "read its surface from surface.ply");
    return std::make_unique<RunReplay>(
        environment_.run_environment, recording_,
        readers_from_first_tap("maps", {kUncertainty, kLabelMean, kObjectProbability, kHeightMean, kHeightStd}, true));
  }
  RunReplay& playback() {
    if (!playback_) playback_ = make_replay();
    return *playback_;
  }

  ObjectLock lock_;
  InterruptibleEnvironment environment_;
  RecordedRun recording_;
  std::unique_ptr<RunReplay> playback_;
};

/// A sweep, or several sweeps and runs that are pooled into one sweep (see read_pooled()). The list of jobs is read
/// when the object is created.
class SweepRecord {
 public:
  explicit SweepRecord(const std::vector<std::string>& directories)
      : SweepRecord(read_pooled({directories.begin(), directories.end()}, {})) {}

  std::string directory() const { return sweep_.directory.string(); }
  /// Returns notes about how the records were pooled and in what they differ, one line each.
  const std::vector<std::string>& notes() const { return notes_; }
  std::size_t size() const { return sweep_.jobs.size(); }
  const std::vector<std::string>& keys() const { return sweep_.keys; }
  std::string job(std::size_t index) const { return job_directory(sweep_, sweep_.jobs.at(index)).string(); }

  /// Writes results.csv again, from the records of the jobs.
  void write_table() const {
    const GilRelease no_gil;
    write_results(sweep_);
  }

  /// Returns one row per job. The row of a job that has not ended has only the swept keys.
  std::vector<Column> table() const {
    std::vector<Row> rows;
    {
      const GilRelease no_gil;
      rows.reserve(sweep_.jobs.size());
      for (const Job& job : sweep_.jobs)
        rows.push_back(result_row(sweep_, job, read_outcome(job_directory(sweep_, job)).value_or(Row())));
    }
    return columns_of(rows);
  }

 private:
  explicit SweepRecord(PooledSweep pooled) : sweep_(std::move(pooled.sweep)), notes_(std::move(pooled.notes)) {}

  Sweep sweep_;
  std::vector<std::string> notes_;
};

}  // namespace palpate
