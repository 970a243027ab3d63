// SPDX-License-Identifier: MIT
// A run whose taps the caller makes, for Python.
#pragma once

#include "answers/answer.hpp"
#include "experiment/from_above.hpp"
#include "record/callers_run.hpp"
#include "record/tap_row.hpp"
#include "shop.hpp"
#include "values.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A run whose taps the caller makes.
class Asked {
 public:
  Asked(const std::string& config, const std::vector<std::string>& overrides, const std::string& runs, bool force) {
    const ResolvedConfig resolved = resolve(config, overrides);
    run_ = CallersRun::start(shop_.workshop, resolved, directory_of(resolved, runs), force);
  }
  Asked(const std::string& directory, bool retry_failed, bool force) {
    run_ = CallersRun::resume(shop_.workshop, directory, {retry_failed, force});
  }

  std::optional<TapRecord> ask(const std::optional<Array>& scores) {
    std::optional<Eigen::VectorXd> values;
    if (scores) values = checked(*scores);
    const py::gil_scoped_release free;
    const TapRecord* tap = open().begin(values ? &*values : nullptr);
    return tap != nullptr ? std::optional(*tap) : std::nullopt;
  }

  void tell(Contact contact) {
    const py::gil_scoped_release free;
    open().end(std::move(contact));
  }

  std::string finish() {
    const py::gil_scoped_release free;
    return to_json_text(open().finish().summary);
  }
  /// Lets go of the directory; what is not finished can be carried on.
  void close() { run_.reset(); }

  bool finished() { return open().finished(); }
  std::string directory() { return open().directory().string(); }
  int taps() { return open().experiment().counts().taps; }
  std::pair<int, int> shape() {
    const Candidates& candidates = open().experiment().candidates();
    return {candidates.rows, candidates.columns};
  }
  FromAbove& experiment() { return open().experiment(); }

 private:
  CallersRun& open() {
    if (!run_) throw Error("experiment", "is closed", "palpate.Experiment.resume(DIR) carries it on");
    return *run_;
  }
  Eigen::VectorXd checked(const Array& scores) {
    const auto wanted = static_cast<py::ssize_t>(open().experiment().candidates().size());
    if (scores.size() != wanted) {
      throw Error("scores", "has " + std::to_string(scores.size()) + " values",
                  "give one a candidate, " + std::to_string(wanted));
    }
    const py::array_t<double, py::array::c_style | py::array::forcecast> dense(scores);
    Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(dense.data(), wanted);
    if (!out.allFinite()) throw Error("scores", "has a value that is not a finite number", "0 is worth nothing");
    return out;
  }

  Shop shop_;
  std::unique_ptr<CallersRun> run_;
};

/// The result of a tap as a backend would have returned it. Throws Error for an outcome that no answer may have.
inline Contact contact_of(const std::string& outcome, double height, double force, double seconds,
                          const std::string& reason, bool ends_run) {
  const std::optional<Outcome> known = answered_outcome(outcome);
  if (!known) {
    throw Error("tell", "there is no outcome '" + plain_line(outcome) + "'",
                "it is contact, no_contact, unreachable, timeout or aborted");
  }
  return {*known, height, force, seconds, reason, ends_run};
}

}  // namespace palpate
