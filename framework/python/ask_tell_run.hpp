// SPDX-License-Identifier: MIT
// A run for Python in which the calling program makes the taps: ask() returns a tap to make, and tell() takes its
// result.
#pragma once

#include "answers/tap_result_checks.hpp"
#include "experiment/experiment.hpp"
#include "module_host.hpp"
#include "record/json.hpp"
#include "record/run.hpp"
#include "threads.hpp"
#include "values.hpp"

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A run in which the calling program makes the taps. Any thread that holds the GIL may call the methods. A lock
/// ensures that only one thread at a time uses the run.
class AskTellRun {
 public:
  AskTellRun(const std::string& config, const std::vector<std::string>& overrides, const std::string& runs,
             bool force) {
    const ObjectGuard guard(lock_);
    const ResolvedConfig resolved = resolve(config, overrides);
    run_ = started(
        Run::start(environment_.run_environment, resolved, directory_of(resolved, runs), {force, TapMaker::by_caller}));
    describe();
  }
  AskTellRun(const std::string& directory, bool retry_failed, bool force) {
    const ObjectGuard guard(lock_);
    run_ = started(Run::resume(environment_.run_environment, directory, {retry_failed, force, TapMaker::by_caller}));
    describe();
  }
  /// In a forked child the run is never destroyed, because its destructor would wait for threads that do not exist in
  /// the child.
  ~AskTellRun() {
    if (!lock_.is_here()) static_cast<void>(run_.release());
  }

  std::optional<TapRecord> ask(const std::optional<Array>& scores) {
    std::optional<Eigen::VectorXd> values;
    if (scores) values = checked(*scores, has_grid() ? py::ssize_t{rows()} * columns() : lines().rows);
    const ObjectGuard guard(lock_);
    const TapRecord* tap = open().ask(values ? &*values : nullptr);
    return tap != nullptr ? std::optional(*tap) : std::nullopt;
  }

  void tell(TapResult result) {
    const ObjectGuard guard(lock_);
    open().tell(std::move(result));
  }

  std::string finish() {
    const ObjectGuard guard(lock_);
    return to_json(open().finish().summary);
  }
  /// Closes the record, even if an exception is thrown. If `finish` is set and no tap is pending, ends the run first. A
  /// run that has not ended can be resumed later. In the child of a fork, this function does nothing.
  void close(bool finish) {
    if (!lock_.is_here()) return;
    const ObjectGuard guard(lock_);
    const std::unique_ptr<Run> run = std::move(run_);
    if (run && finish && !run->is_finished() && !run->is_pending()) run->finish();
  }

  bool finished() {
    const ObjectGuard guard(lock_);
    return open().is_finished();
  }
  int taps() {
    const ObjectGuard guard(lock_);
    return open().experiment().counts().taps;
  }
  /// Returns a copy of the current values of a quantity: a map with one row per y and one column per x, or a single row
  /// if the candidates are not on a grid.
  Map map(const std::string& quantity) {
    const ObjectGuard guard(lock_);
    const Eigen::VectorXd& values = open().look({quantity}).values(quantity);
    return has_grid() ? Map{values, rows(), columns()} : Map{values, 1, static_cast<int>(values.size())};
  }
  /// Returns the current candidate lines, one per row: start (x, y, z), direction (x, y, z) and length; metres.
  Map lines() {
    const ObjectGuard guard(lock_);
    const Candidates& lines = open().look({}).candidates();
    Eigen::Matrix<double, 7, Eigen::Dynamic> all(7, lines.size());
    for (Eigen::Index i = 0; i < lines.size(); ++i) {
      const TapLine line = lines.line(i);
      all.col(i) << line.start, line.direction, line.length;
    }
    return {all.reshaped(), static_cast<int>(lines.size()), 7};
  }
  bool has_grid() const { return rows() > 0; }

  const std::string& directory() const { return directory_; }
  const std::string& label() const { return label_; }
  const Eigen::VectorXd& xs() const { return xs_; }
  const Eigen::VectorXd& ys() const { return ys_; }

 private:
  /// Sets the properties that do not change during the run.
  void describe() {
    directory_ = run_->directory().string();
    if (const Tree* label = run_->config().tree.find_path("backend.label")) label_ = label->text;
    const CandidateGrid grid = grid_of(run_->experiment().belief().candidates());
    xs_ = grid.xs;
    ys_ = grid.ys;
  }
  int rows() const { return static_cast<int>(ys_.size()); }
  int columns() const { return static_cast<int>(xs_.size()); }

  /// Returns `run`, which was just started or resumed. Throws Error if it is already finished.
  static std::unique_ptr<Run> started(std::unique_ptr<Run> run) {
    if (!run->is_finished()) return run;
    throw Error(run->finish().directory.string(), "this run is finished",
                "add force=True to move it aside and run again");
  }

  Run& open() {
    if (!run_) throw Error("experiment", "is closed", "resume the run with palpate.Experiment.resume(DIR)");
    return *run_;
  }
  static Eigen::VectorXd checked(const Array& scores, py::ssize_t wanted) {
    if (scores.size() != wanted)
      throw Error("scores", "has " + std::to_string(scores.size()) + " values",
                  "give one per candidate, " + std::to_string(wanted));
    const py::array_t<double, py::array::c_style | py::array::forcecast> dense(scores);
    Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(dense.data(), wanted);
    if (!out.allFinite()) throw Error("scores", "has a value that is not a finite number", "use 0 for a worthless tap");
    return out;
  }

  ObjectLock lock_;
  InterruptibleEnvironment environment_;
  std::unique_ptr<Run> run_;
  std::string directory_;
  std::string label_;
  Eigen::VectorXd xs_;
  Eigen::VectorXd ys_;
};

/// Returns the result of a tap in the form in which a backend would return it. Throws Error for an outcome that the
/// calling program must not report.
inline TapResult result_of(const std::string& outcome, std::optional<double> height, std::optional<double> distance,
                           const std::optional<std::array<double, 3>>& contact, double force, double seconds,
                           const std::string& reason, bool ends_run) {
  const std::optional<Outcome> known = answered_outcome(outcome);
  if (!known)
    throw Error("tell", "unknown outcome '" + plain_line(outcome) + "'",
                "use contact, no_contact, unreachable, timeout or aborted");
  TapResult out = tap_without_contact(*known, seconds, reason, ends_run);
  // The height is only the z coordinate of the touched point. If the tap comes from above, x and y follow from the
  // tap's line.
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (height) out.contact.emplace(kUnknown, kUnknown, *height);
  if (contact) out.contact.emplace((*contact)[0], (*contact)[1], (*contact)[2]);
  out.distance = distance;
  out.force = force;
  return out;
}

}  // namespace palpate
