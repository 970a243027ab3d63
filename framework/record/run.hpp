// SPDX-License-Identifier: MIT
// A run, from its config to its summary, in its directory.
#pragma once

#include "experiment/experiment.hpp"
#include "host/host.hpp"
#include "record/build_info.hpp"
#include "record/recorded_run.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"
#include "record/run_directory.hpp"
#include "record/summary.hpp"

#include <palpate/error.hpp>

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// What every run of this process shares.
struct RunEnvironment {
  const PluginHost& host;
  const Installation& installation;
  std::vector<std::string> command_line;
  const std::atomic<bool>* interrupted;  ///< set by the user's wish to stop; may be null
};

/// The backend of a run whose taps are made by a calling program.
inline constexpr const char* kCaller = "caller";
/// Who makes the taps of a run.
enum class Taps { by_backend, by_caller };

/// Names of files that an ended run had lost.
struct RestoredFiles {
  std::vector<std::string> made;  ///< again, byte for byte
  std::vector<std::string> lost;  ///< left out: this build makes others from the same taps
};

/// How a run ended.
struct RunReport {
  std::filesystem::path directory;
  bool already_done = false;  ///< nothing was run: the directory held the finished run
  bool interrupted = false;   ///< it can be resumed; there is no summary
  Row summary;                ///< the fields of summary.json
  RestoredFiles restored{};   ///< of a finished run
};

struct StartOptions {
  bool force = false;  ///< move an old run aside
  Taps taps = Taps::by_backend;
  bool asks_before_taps = false;  ///< an observer asks a person: only where taps cannot be repeated
};

struct ResumeOptions {
  bool retry_failed = false;  ///< resume a failed run too
  bool force = false;         ///< resume a run of another build
  Taps taps = Taps::by_backend;
  bool asks_before_taps = false;
};

/// A run that this process holds.
class Run {
 public:
  /// Starts `config` in `directory`; `observers` (which outlive it) hear of each tap after the record. A finished run
  /// of the same build is left alone: is_finished(). A finished run of another build, a failed or an interrupted one
  /// throws Error with the remedy; with `force` the old directory is moved to <id>.old-N first.
  static std::unique_ptr<Run> start(const RunEnvironment& environment, const ResolvedConfig& config,
                                    const std::filesystem::path& directory, const StartOptions& options,
                                    std::vector<Observer*> observers = {});

  /// Resumes the run in `directory` from its config and its recorded taps; repeats none. A finished run is left alone.
  static std::unique_ptr<Run> resume(const RunEnvironment& environment, const std::filesystem::path& directory,
                                     const ResumeOptions& options, std::vector<Observer*> observers = {});
  /// The same with `config`, which is that of the run, in a directory that this process holds.
  static std::unique_ptr<Run> resume(const RunEnvironment& environment, const ResolvedConfig& config,
                                     std::shared_ptr<RunDirectory> held, const ResumeOptions& options,
                                     std::vector<Observer*> observers = {});

  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Makes all taps that are left, and finishes. If the run fails, its summary says so, and the Error, of kind `run`,
  /// is thrown on.
  const RunReport& run();

  /// Returns the tap that the caller is to make, announced in the record: the same until tell(). `scores` (may be null;
  /// finite, one per candidate) choose it in the place of the strategy. Returns null when the run is over and finished.
  const TapRecord* ask(const Eigen::VectorXd* scores);
  /// Takes the result of that tap. Throws Error of kind `usage` for a value that no arm can have measured (see
  /// answers/tap_result_checks.hpp; `hover` and `overrun` of the backend bound the heights): nothing is recorded then.
  /// Throws Error of kind `run`, and finishes the run, when it cannot continue.
  void tell(TapResult result);
  /// Whether ask() has returned a tap whose result tell() has not taken.
  bool is_pending() const { return tap_.has_value(); }

  /// Writes what ends the run, its budget reached or not, and reports it; later calls report the same.
  const RunReport& finish();
  bool is_finished() const { return report_.has_value(); }

  /// Returns a belief with the arrays of these quantities as of now: that of the run if its readers have them, else of
  /// a copy that takes in the same taps, so that looking does not change the record.
  Belief& look(const QuantitySet& quantities);

  /// Only of a run that was not finished before.
  Experiment& experiment() { return *experiment_; }
  const ResolvedConfig& config() const { return config_; }
  const std::filesystem::path& directory() const { return directory_ ? directory_->path() : report_->directory; }

 private:
  class Recorder;

  Run(const Stopwatch& watch, const RunEnvironment& environment, const ResolvedConfig& config,
      std::shared_ptr<RunDirectory> directory, std::unique_ptr<Experiment> experiment,
      std::vector<Observer*> observers);
  /// Of a run that was finished before.
  Run(const ResolvedConfig& config, RunReport report);
  void end(std::string failure);

  const RunEnvironment* environment_ = nullptr;
  Stopwatch watch_;
  ResolvedConfig config_;
  // Null of a run that was finished before.
  std::shared_ptr<RunDirectory> directory_;
  std::unique_ptr<Experiment> experiment_;
  std::unique_ptr<Recorder> recorder_;
  QuantitySet looked_at_;
  std::unique_ptr<Experiment> copy_;  ///< see look()
  std::optional<TapRecord> tap_;      ///< that the caller is to make
  std::optional<RunReport> report_;
};

/// Runs `config` in `directory`, as Run::start() and Run::run() do.
RunReport start_run(const RunEnvironment& environment, const ResolvedConfig& config,
                    const std::filesystem::path& directory, const StartOptions& options,
                    const std::vector<Observer*>& observers = {});
/// Resumes the run in `directory`.
RunReport resume_run(const RunEnvironment& environment, const std::filesystem::path& directory,
                     const ResumeOptions& options, const std::vector<Observer*>& observers = {});

/// Returns the models of this config, each with its readers. Of backends only the simulator is built, as others may
/// connect to something: what they would read is left out. Throws Error for what only building finds out.
std::vector<PlannedModel> models_of(const RunEnvironment& environment, const ResolvedConfig& config);

/// Returns <runs>/<slug>/<id>.
std::filesystem::path directory_of(const ResolvedConfig& config, const std::filesystem::path& runs);

/// Stands in for a backend where nothing is tapped: tap() throws.
std::shared_ptr<Backend> no_backend(bool truth_known);

/// Returns why a run is not to be resumed: it has taps of another build than this one. nullopt if it has not.
std::optional<Error> objection_to_build(const RunEnvironment& environment, const ResolvedConfig& config,
                                        const RunRecord& record);

/// Makes those files again that an ended run in a directory that this process holds has lost: a kill came between its
/// last line and summary.json, or a power cut took what was never synced. Throws Error.
RestoredFiles restore_files(const RunEnvironment& environment, RunDirectory& held);

}  // namespace palpate
