// SPDX-License-Identifier: MIT
// A run whose taps somebody else makes.
#pragma once

#include "experiment/from_above.hpp"
#include "record/course.hpp"

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace palpate {

/// The backend of a run whose taps are made by whoever holds it.
inline constexpr const char* kCaller = "caller";

/// A run whose taps are made outside, one by one: by a program that has an arm of its own, or a strategy. It is
/// recorded as any other, and what is not finished can be carried on. Its backend is `caller`; others are refused by an
/// Error.
class CallersRun {
 public:
  /// As start_run(); a finished run is refused.
  static std::unique_ptr<CallersRun> start(const Workshop& workshop, const ResolvedConfig& config,
                                           const std::filesystem::path& directory, bool force);
  /// As resume_run(); a finished run is refused.
  static std::unique_ptr<CallersRun> resume(const Workshop& workshop, const std::filesystem::path& directory,
                                            const ResumeOptions& options);
  /// `begun` has an experiment.
  CallersRun(const ResolvedConfig& config, Begun begun);
  CallersRun(const CallersRun&) = delete;  // its parts refer to each other
  CallersRun& operator=(const CallersRun&) = delete;
  /// What is not finished then can be carried on.
  ~CallersRun() = default;

  /// The tap to make, announced in the record: the same until end() has its result. `scores` (may be null; finite, one
  /// a candidate) choose it in the place of the strategy. None when the run is over; it is finished then.
  const TapRecord* begin(const Eigen::VectorXd* scores);
  /// Takes the result of the tap. Throws Error of kind `usage` for a value that no arm can have measured (see
  /// answers/answer.hpp; the heights are bounded by the backend's `hover` and `overrun`): nothing is recorded then, and
  /// the tap is still the one to make. Throws Error of kind `run`, and finishes the run, when it cannot go on.
  void end(Contact contact);
  /// Writes what ends a run, its budget reached or not, and reports it. Later calls report the same.
  const RunReport& finish();
  bool finished() const { return report_.has_value(); }
  /// Whether begin() has returned a tap whose result end() has not taken.
  bool pending() const { return tap_.has_value(); }

  FromAbove& experiment() { return from_above_of(*begun_.experiment, directory().string()); }
  const ResolvedConfig& config() const { return config_; }
  const std::filesystem::path& directory() const { return begun_.directory->path(); }

 private:
  void end_with(const std::string& failure);

  Stopwatch watch_;
  ResolvedConfig config_;
  Begun begun_;
  Course course_;
  std::optional<TapRecord> tap_;  ///< that is to be made
  std::optional<RunReport> report_;
};

}  // namespace palpate
