// SPDX-License-Identifier: MIT
// Executes a run in its directory, from its config to its summary.
#pragma once

#include "experiment/experiment.hpp"
#include "host/plugin_host.hpp"
#include "record/build_info.hpp"
#include "record/recorded_run.hpp"
#include "record/resolved_config.hpp"
#include "record/row.hpp"
#include "record/run_directory.hpp"
#include "record/stopwatch.hpp"

#include <palpate/error.hpp>

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Data that all runs of this process share.
struct RunEnvironment {
  const PluginHost& host;
  const Installation& installation;
  std::vector<std::string> command_line;
  const std::atomic<bool>* interrupted;  ///< becomes true when the user asks to stop; may be null
};

/// The name of the backend of runs whose taps are made by a calling program.
inline constexpr const char* kCaller = "caller";
/// The maker of the taps of a run: its backend, or the calling program.
enum class TapMaker { by_backend, by_caller };

/// The files that were missing in the directory of an ended run, by name.
struct RestoredFiles {
  std::vector<std::string> made;  ///< files made again, byte for byte
  std::vector<std::string> lost;  ///< files not made again, because this build makes different ones from the same taps
};

/// How a run ended.
struct RunConclusion {
  std::filesystem::path directory;
  bool already_done = false;  ///< true if nothing was run, because the directory contained the finished run
  bool interrupted = false;   ///< the run can be resumed, and has no summary
  Row summary;                ///< the fields of summary.json
  RestoredFiles restored{};   ///< only if the run had already finished
};

struct StartOptions {
  bool force = false;  ///< move an old run aside
  TapMaker taps = TapMaker::by_backend;
  bool asks_before_taps =
      false;  ///< an observer asks a person before each tap; allowed only if taps cannot be repeated
};

struct ResumeOptions {
  bool retry_failed = false;  ///< resume a failed run too
  bool force = false;         ///< resume a run of another build
  TapMaker taps = TapMaker::by_backend;
  bool asks_before_taps = false;
};

/// A run whose directory this process has locked.
class Run {
 public:
  /// Starts `config` in `directory`. `observers`, which must outlive the run, are called after each tap is recorded. If
  /// the directory holds the same run, finished by the same build, nothing is run: see is_finished(). Throws Error if
  /// the directory holds a failed or interrupted run, or a run of another build. With `force` the old directory is
  /// moved to <id>.old-N instead.
  static std::unique_ptr<Run> start(const RunEnvironment& environment, const ResolvedConfig& config,
                                    const std::filesystem::path& directory, const StartOptions& options,
                                    std::vector<Observer*> observers = {});

  /// Resumes the run in `directory` from its config and its recorded taps; no recorded tap is made again. A finished
  /// run is not changed.
  static std::unique_ptr<Run> resume(const RunEnvironment& environment, const std::filesystem::path& directory,
                                     const ResumeOptions& options, std::vector<Observer*> observers = {});
  /// Resumes the run in a directory that this process has locked; `config` is the config of that run.
  static std::unique_ptr<Run> resume(const RunEnvironment& environment, const ResolvedConfig& config,
                                     std::shared_ptr<RunDirectory> held, const ResumeOptions& options,
                                     std::vector<Observer*> observers = {});

  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Makes all remaining taps and finishes the run. If the run fails, its summary contains the reason, and an Error of
  /// kind `run` is thrown.
  const RunConclusion& run();

  /// Returns the tap that the caller must make, and announces it in the record. Until tell() is called, further calls
  /// return the same tap. `scores`, if not null, replace the scores of the strategy: one finite number per candidate.
  /// Returns null when the run is finished.
  const TapRecord* ask(const Eigen::VectorXd* scores);
  /// Records the result of the pending tap. Throws Error of kind `usage`, and records nothing, for a value that no arm
  /// can have measured (see answers/tap_result_checks.hpp; `hover` and `overrun` of the backend bound the heights). If
  /// the run cannot continue, finishes it and throws Error of kind `run`.
  void tell(TapResult result);
  /// Returns whether ask() has returned a tap for which tell() has not been called yet.
  bool is_pending() const { return tap_.has_value(); }

  /// Ends the run, even before its budget is reached, and returns its report. Later calls return the same report.
  const RunConclusion& finish();
  bool is_finished() const { return report_.has_value(); }

  /// Returns a belief with the current arrays of these quantities. If parts of the run already read these quantities,
  /// this is the belief of the run itself. Otherwise, it is the belief of a copy of the run with the same taps, so that
  /// the call does not change the record.
  Belief& look(const QuantitySet& quantities);

  /// Do not call this for a run that had already finished when it was started or resumed, because such a run has no
  /// experiment.
  Experiment& experiment() { return *experiment_; }
  const ResolvedConfig& config() const { return config_; }
  const std::filesystem::path& directory() const { return directory_ ? directory_->path() : report_->directory; }

 private:
  class Recorder;

  Run(const Stopwatch& watch, const RunEnvironment& environment, const ResolvedConfig& config,
      std::shared_ptr<RunDirectory> directory, std::unique_ptr<Experiment> experiment,
      std::vector<Observer*> observers);
  /// Constructs a run that had already finished when it was started or resumed.
  Run(const ResolvedConfig& config, RunConclusion report);
  void end(std::string failure);

  const RunEnvironment* environment_ = nullptr;
  Stopwatch watch_;
  ResolvedConfig config_;
  // The next three are null if the run had already finished when it was started or resumed.
  std::shared_ptr<RunDirectory> directory_;
  std::unique_ptr<Experiment> experiment_;
  std::unique_ptr<Recorder> recorder_;
  QuantitySet looked_at_;
  std::unique_ptr<Experiment> copy_;  ///< see look()
  std::optional<TapRecord> tap_;      ///< the pending tap, which the caller must make
  std::optional<RunConclusion> report_;
};

/// Runs `config` in `directory`, as Run::start() and Run::run() do.
RunConclusion start_run(const RunEnvironment& environment, const ResolvedConfig& config,
                        const std::filesystem::path& directory, const StartOptions& options,
                        const std::vector<Observer*>& observers = {});
/// Resumes the run in `directory`.
RunConclusion resume_run(const RunEnvironment& environment, const std::filesystem::path& directory,
                         const ResumeOptions& options, const std::vector<Observer*>& observers = {});

/// Returns the models of this config, each with the parts of the run that read it. Builds no backend except the
/// simulator, because other backends may connect to a device. Models that only another backend would read are left out.
/// Throws Error if the experiment cannot be built.
std::vector<PlannedModel> models_of(const RunEnvironment& environment, const ResolvedConfig& config);

/// Returns <runs>/<slug>/<id>.
std::filesystem::path directory_of(const ResolvedConfig& config, const std::filesystem::path& runs);

/// Returns a backend for experiments that make no taps. Its function tap() throws.
std::shared_ptr<Backend> no_backend(bool truth_known);

/// Returns an Error if another build made taps of the run, so that this build must not resume it; else nullopt.
std::optional<Error> objection_to_build(const RunEnvironment& environment, const ResolvedConfig& config,
                                        const RunRecord& record);

/// Restores missing files of an ended run in a directory that this process has locked. Files are missing if the process
/// was killed after the last line of the record but before it wrote summary.json, or after a power failure before a
/// sync. Throws Error.
RestoredFiles restore_files(const RunEnvironment& environment, RunDirectory& held);

}  // namespace palpate
