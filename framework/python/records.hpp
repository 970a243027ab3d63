// SPDX-License-Identifier: MIT
// What is recorded, for Python: a run with its taps and models, a sweep with its jobs.
#pragma once

#include "experiment/from_above.hpp"
#include "experiment/metrics.hpp"
#include "record/recording.hpp"
#include "record/run_directory.hpp"
#include "record/run_files.hpp"
#include "shop.hpp"
#include "sweep/sweep.hpp"
#include "values.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// What is believed as of now, in arrays of the caller's.
inline py::dict maps_of(FromAbove& experiment) {
  experiment.build(Quantity::uncertainty | Quantity::weight | Quantity::probability | Quantity::height);
  const TapBelief& belief = experiment.belief();
  const int rows = experiment.candidates().rows;
  const int columns = experiment.candidates().columns;
  py::dict out;
  out["height_mean"] = copied(belief.height_mean(), rows, columns);
  out["height_standard_deviation"] = copied(belief.height_variance().cwiseMax(0.0).cwiseSqrt(), rows, columns);
  out["uncertainty"] = copied(belief.uncertainty(), rows, columns);
  out["weight"] = copied(belief.weight(), rows, columns);
  out["probability"] = copied(belief.probability(), rows, columns);
  out["surface"] = copied(reconstruction(belief), rows, columns);
  return out;
}

/// A run directory and its models.
class Record {
 public:
  explicit Record(const std::string& directory) : recording_(read_recording(shop_.workshop, directory)) {}

  py::object config() const { return python_of(recording_.config.tree); }
  std::string id() const { return recording_.config.id; }
  std::vector<Column> taps() const { return columns_of(recording_.rows); }
  int size() const { return static_cast<int>(recording_.rows.size()); }
  /// None where there is none.
  py::object manifest() const {
    const std::optional<Tree> manifest = RunFiles(recording_.directory).manifest();
    return manifest ? py::module_::import("json").attr("loads")(to_json(*manifest)) : py::none();
  }

  /// The models after so many taps.
  py::dict after(int taps) {
    if (taps < 0 || taps > size())
      throw Error("after", "there are " + std::to_string(size()) + " taps, not " + std::to_string(taps), "take fewer");
    if (!playback_ || playback_->taps() > taps) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    {
      const py::gil_scoped_release free;
      playback_->advance_to(taps);
    }
    return maps_of(playback_->from_above());
  }

  /// The heights of the scene that was tapped; None where another world was.
  py::object truth() {
    if (!playback_) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    FromAbove& experiment = playback_->from_above();
    const Truth* truth = experiment.truth();
    if (truth == nullptr) return py::none();
    return copied(truth->height, experiment.candidates().rows, experiment.candidates().columns);
  }

  std::pair<Array, Array> axes() {
    if (!playback_) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    const Candidates& candidates = playback_->from_above().candidates();
    return {Array(candidates.xs.size(), candidates.xs.data()), Array(candidates.ys.size(), candidates.ys.data())};
  }

 private:
  Shop shop_;
  Recording recording_;
  std::unique_ptr<Playback> playback_;
};

/// The directory of a sweep, as it stood when it was opened.
class SweepRecord {
 public:
  explicit SweepRecord(const std::string& directory) : sweep_(read_sweep(directory)) {}

  std::string directory() const { return sweep_.directory.string(); }
  std::size_t size() const { return sweep_.jobs.size(); }
  const std::vector<std::string>& keys() const { return sweep_.keys; }
  std::string job(std::size_t index) const { return job_directory(sweep_, sweep_.jobs.at(index)).string(); }

  /// A row a job, of those that have not ended the swept keys alone.
  std::vector<Column> table() const {
    std::vector<Row> rows;
    rows.reserve(sweep_.jobs.size());
    for (const Job& job : sweep_.jobs)
      rows.push_back(result_row(sweep_, job, read_outcome(job_directory(sweep_, job)).value_or(Row())));
    return columns_of(rows);
  }

 private:
  Sweep sweep_;
};

}  // namespace palpate
