// SPDX-License-Identifier: MIT
#include "record/run.hpp"

#include "answers/tap_result_checks.hpp"
#include "config/catch_error.hpp"
#include "config/hash.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "math/instructions.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/run_replay.hpp"
#include "record/surface_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Returns the manifest, which contains only data known before the experiment is built.
Tree manifest_of(const RunEnvironment& environment, const ResolvedConfig& config) {
  Tree out = Tree::map(
      {{"name", Tree::quote(config.options.name)}, {"id", Tree::quote(config.id)}, {"at", Tree::quote(now_text())}});
  const Tree build = describe_build(environment.installation, environment.host, config.notes.plugins,
                                    math::name_of(math::choose_instructions()));
  out.entries.insert(out.entries.end(), build.entries.begin(), build.entries.end());
  const auto places = [](const std::vector<ResolveNotes::Origin>& of) {
    Tree all = Tree::map();
    for (const ResolveNotes::Origin& one : of) all.entries.push_back({one.path, {}, Tree::quote(one.place)});
    return all;
  };
  out.at("identity") = Tree::quote(config.identity);
  Tree& line = out.at("command_line") = Tree::list();
  for (const std::string& word : environment.command_line) line.items.push_back(Tree::quote(word));
  out.at("dropped") = places(config.notes.dropped);
  return out;
}

/// Records that the experiment is built, and which parts of the run read each model. If taps cannot be repeated, they
/// are announced, so that the record contains each tap even if the process ends during the tap.
void set_up(const Experiment& experiment, RunDirectory& directory) {
  Tree models = Tree::map();
  for (const PlannedModel& one : experiment.plan().models) {
    Tree& readers = models.at(one.model);
    readers.kind = Tree::Kind::list;
    readers.items.push_back(Tree::quote(one.reader));
  }
  directory.set_up(!experiment.backend().repeatable(), models);
}

/// Turns on syncing of all later writes if the config or the backend requires it.
void sync_if_needed(const ResolvedConfig& config, const Experiment& experiment, RunDirectory& directory) {
  const LogOptions::Sync sync = config.options.log.sync;
  const bool once = !experiment.backend().repeatable();
  if (sync == LogOptions::Sync::tap || (once && sync != LogOptions::Sync::none)) directory.sync();
}

void move_away(const fs::path& directory) {
  for (int n = 1;; ++n) {
    const fs::path old = directory.string() + fmt::format(".old-{}", n);
    if (fs::exists(old)) continue;
    fs::rename(directory, old);
    return;
  }
}

/// Builds the experiment. An Error about an option gets the location in the config where the option was set.
std::unique_ptr<Experiment> build_experiment(const ResolvedConfig& config, const ExperimentSetup& setup) {
  try {
    return std::make_unique<Experiment>(config.options, setup);
  } catch (const Error& trouble) {
    const std::string place = config.tree.place_of(trouble.where()).text();
    if (place.empty()) throw;
    throw Error(place, trouble.where() + ": " + trouble.reason(), trouble.hint(), trouble.kind());
  }
}

/// Records the end of a run that could not be resumed. If the run had failed before, its former end is recorded again.
/// If another process uses the arm, the attempt ends as interrupted.
void take_back(RunDirectory& held, const std::optional<Ending>& before, const Error& trouble) {
  if (before && before->how == Ending::EndKind::failed) {
    held.end(*before);
  } else if (trouble.kind() == Error::Kind::busy) {
    held.end({Ending::EndKind::interrupted, trouble.what(), {}, {}});
  }
}

/// Throws Error if the taps can be repeated, because asking a person before each tap is then pointless.
void check_worth_asking(const ResolvedConfig& config, const Experiment& experiment) {
  if (!experiment.backend().repeatable()) return;
  throw Error("command line",
              fmt::format("--step: the taps of backend {} can be repeated and need no confirmation",
                          config.options.backend.type),
              "leave it out");
}

/// Throws Error if the backend of the config does not match `taps`. `command` is "run" or "resume", for the hint.
void check_who_taps(const ResolvedConfig& config, TapMaker taps, const std::string& command) {
  const std::string& backend = config.options.backend.type;
  const bool by_caller = backend == kCaller;
  if (by_caller == (taps == TapMaker::by_caller)) return;
  if (by_caller)
    throw Error("backend", "the taps of this run are made by the caller's own program, not by palpate",
                command == "run" ? "run it with palpate.Experiment(...) in Python, or choose another backend"
                                 : "resume it with palpate.Experiment.resume(DIR) in Python");
  throw Error("backend", fmt::format("the taps of this run are made by backend {}, not by a caller", backend),
              command == "run" ? "choose the backend caller" : "resume it with 'palpate resume'");
}

/// Throws Error if a directory holds a run that a new one would overwrite. Returns true if the directory holds the same
/// run, finished by the same build.
bool is_done_there(const RunEnvironment& environment, const ResolvedConfig& config, const fs::path& directory,
                   const RunStatus& status) {
  const std::string where = directory.string();
  const RunIdentity other = read_identity(directory);
  const bool has_name = other.name.empty() || other.name == config.options.name;
  if (!has_name || (!other.identity.empty() && other.identity != config.identity))
    throw Error(where,
                has_name ? fmt::format("the folder contains another run with the id {}", config.id)
                         : fmt::format("the folder contains a run with the name '{}'", other.name),
                "give this run another name");
  switch (status.state) {
    case RunStatus::State::done:
      if (read_run_record(directory).build() == build_hash(environment.host, config.notes.plugins)) return true;
      throw Error(where, "this run was finished by another build of palpate or its plugins",
                  "add --force to move it aside and run again");
    case RunStatus::State::failed:
      throw Error(where, fmt::format("this run failed: {}", status.stop_reason),
                  "resume it with 'palpate resume --retry-failed', or start again with --force");
    default:
      throw Error(where, fmt::format("this run was interrupted after {} taps", status.taps),
                  "resume it with 'palpate resume', or start again with --force");
  }
}

HeightBounds bounds_of(const ResolvedConfig& config, const Experiment& experiment) {
  const auto length = [&](const char* name) {
    const Tree* const value = config.tree.find_path(std::string("backend.") + name);
    if (value == nullptr) throw Error("backend", std::string("has no option '") + name + "'", "rebuild the plugin");
    return read_quantity(*value, name, Unit::metre);
  };
  return height_bounds(experiment.scene().desk(), length("overrun"), length("hover"));
}

/// Calls `part` and returns the message of its exception; "" if it does not throw.
template <class Part>
std::string failure_in(const Part& part) {
  try {
    part();
    return {};
  } catch (const std::exception& trouble) {
    return trouble.what();
  } catch (...) {
    return "a plugin threw an object that is not a std::exception";
  }
}

RunConclusion report_done(const RunEnvironment& environment, RunDirectory& held) {
  return {held.path(), true, false, held.before().end->summary, restore_files(environment, held)};
}

}  // namespace

/// Observes the experiment of a run. Records each tap before it calls the run's observers, and writes maps if the
/// config requires them. A tap is made only if all observers permit it.
class Run::Recorder final : public Observer {
 public:
  Recorder(Run& run, std::vector<Observer*> observers)
      : run_(run), directory_(*run.directory_), experiment_(*run.experiment_), observers_(std::move(observers)) {}

  bool permits(const TapRecord& tap, const Experiment& experiment) override {
    for (Observer* const one : observers_) {
      if (!one->permits(tap, experiment)) return false;
    }
    return true;
  }

  void announce(const TapRecord& tap) override {
    shown_ = {};
    for (const Observer* const one : observers_) {
      if (one->wants_errors()) return announce_shown(tap);
    }
    announce_recorded(tap);
  }

  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override {
    TapRecord told = tap;
    told.shown_expected_rmse = shown_.expected_rmse;  // recorded with the times, not with the tap
    {
      const PhaseClock::Scope log(&experiment_.clock(), Phase::log);
      directory_.record(told, seconds);
    }
    told.errors = shown_.errors;
    for (Observer* const one : observers_) one->record(told, seconds);
  }

 private:
  void announce_shown(const TapRecord& tap) {
    try {
      shown_ = errors_for_displays();
    } catch (const std::exception&) {  // an error of a model used only for displays must not end the run
    }
    announce_recorded(tap);
  }

  void announce_recorded(const TapRecord& tap) {
    {
      const PhaseClock::Scope log(&experiment_.clock(), Phase::log);
      if (run_.config_.options.log.maps) write_maps(tap);
      directory_.announce(tap);
    }
    for (Observer* const one : observers_) one->announce(tap);
  }

  /// Returns the errors that displays show. If a model that they need is missing in the run and the truth is known, a
  /// copy of the run with all needed models computes them.
  BeliefErrors errors_for_displays() {
    if (const auto own = experiment_.belief().errors(ErrorsFor::display)) return *own;
    if (!experiment_.backend().scene_is_truth()) return {};
    Belief& copy = run_.look({quantity::kHeightMean, quantity::kObjectProbability});
    return copy.errors(ErrorsFor::display).value_or(BeliefErrors());
  }

  void write_maps(const TapRecord& tap) const {
    const std::string text = maps_csv(experiment_.belief(), tap.state);
    if (text.empty()) return;
    make_inner_folder(directory_.path() / "maps");
    directory_.write(fmt::format("maps/tap_{:03}.csv", tap.number()), text);
  }

  Run& run_;
  RunDirectory& directory_;
  Experiment& experiment_;
  std::vector<Observer*> observers_;
  BeliefErrors shown_;  ///< errors before the current tap
};

Run::Run(const Stopwatch& watch, const RunEnvironment& environment, const ResolvedConfig& config,
         std::shared_ptr<RunDirectory> directory, std::unique_ptr<Experiment> experiment,
         std::vector<Observer*> observers)
    : environment_(&environment),
      watch_(watch),
      config_(config),
      directory_(std::move(directory)),
      experiment_(std::move(experiment)),
      recorder_(std::make_unique<Recorder>(*this, std::move(observers))) {}

Run::Run(const ResolvedConfig& config, RunConclusion report) : config_(config), report_(std::move(report)) {}

Run::~Run() = default;

std::unique_ptr<Run> Run::start(const RunEnvironment& environment, const ResolvedConfig& config,
                                const fs::path& directory, const StartOptions& options,
                                std::vector<Observer*> observers) {
  const Stopwatch watch;
  check_who_taps(config, options.taps, "run");
  if (is_running(directory)) FileLock{directory / kRecordFile};  // throws Error of kind `busy`
  RunStatus status;
  if (const auto trouble = catch_error([&] { status = read_record(directory); })) {
    // With `force`, a record that cannot be read is moved aside instead.
    if (!options.force || trouble->kind() != Error::Kind::usage) throw Error(*trouble);
    status.state = RunStatus::State::unfinished;
  }
  const bool is_there = status.state != RunStatus::State::absent;
  if (is_there && !options.force && is_done_there(environment, config, directory, status)) {
    const RunStatus end = read_ending(directory);
    if (!lacks_files(directory, end.end.value()))
      return std::unique_ptr<Run>(new Run(config, {directory, true, false, end.end->summary}));
    RunDirectory held(directory);
    return std::unique_ptr<Run>(new Run(config, report_done(environment, held)));
  }
  // The experiment is built before the directory is changed, so that an error in building leaves the directory
  // unchanged.
  std::unique_ptr<Experiment> experiment =
      build_experiment(config, {environment.host, environment.interrupted, nullptr, directory.string()});
  if (options.asks_before_taps) check_worth_asking(config, *experiment);
  if (is_there) {
    const FileLock old(directory / kRecordFile);  // throws if another process has resumed the old run meanwhile
    move_away(directory);
  }
  auto held = std::make_shared<RunDirectory>(directory);
  // Another process may have started or finished this run while this process built the experiment.
  if (read_record(directory).state != RunStatus::State::absent)
    throw Error(directory.string(), "another process has just finished this run",
                "repeat the command to see how it ended", Error::Kind::busy);
  sync_if_needed(config, *experiment, *held);
  held->write_config(to_yaml_with_places(config.tree));
  held->begin(manifest_of(environment, config));
  held->begin_attempt(build_hash(environment.host, config.notes.plugins), options.force);
  set_up(*experiment, *held);
  return std::unique_ptr<Run>(
      new Run(watch, environment, config, std::move(held), std::move(experiment), std::move(observers)));
}

std::unique_ptr<Run> Run::resume(const RunEnvironment& environment, const fs::path& directory,
                                 const ResumeOptions& options, std::vector<Observer*> observers) {
  // The config is read first, so that a directory without a run does not become a run directory.
  const ResolvedConfig config = load_run(environment.host, directory);
  return resume(environment, config, std::make_shared<RunDirectory>(directory), options, std::move(observers));
}

std::unique_ptr<Run> Run::resume(const RunEnvironment& environment, const ResolvedConfig& config,
                                 std::shared_ptr<RunDirectory> held, const ResumeOptions& options,
                                 std::vector<Observer*> observers) {
  const Stopwatch watch;
  const fs::path& directory = held->path();
  const RunRecord& before = held->before();
  const std::optional<Ending> end = before.end;
  if (end && end->how == Ending::EndKind::done)
    return std::unique_ptr<Run>(new Run(config, report_done(environment, *held)));
  check_who_taps(config, options.taps, "resume");
  if (end && end->how == Ending::EndKind::failed && !options.retry_failed)
    throw Error(directory.string(), fmt::format("this run failed: {}", end->reason), "resume it with --retry-failed",
                Error::Kind::run);
  const auto objection = options.force ? std::nullopt : objection_to_build(environment, config, before);
  if (objection) throw *objection;
  // The summary is out of date, or belongs to a record that was cut.
  std::error_code none;
  fs::remove(directory / kSummaryFile, none);
  if (before.is_failure_alone()) held->clear();
  if (!before.manifest) held->begin(manifest_of(environment, config));
  held->begin_attempt(build_hash(environment.host, config.notes.plugins), options.force);
  std::unique_ptr<Experiment> experiment;
  const std::optional<Error> trouble = catch_error([&] {
    experiment = build_experiment(config, {environment.host, environment.interrupted, nullptr, directory.string()});
    if (options.asks_before_taps) check_worth_asking(config, *experiment);
    sync_if_needed(config, *experiment, *held);
    set_up(*experiment, *held);
    experiment->resume(held->recover());
  });
  if (!trouble)
    return std::unique_ptr<Run>(
        new Run(watch, environment, config, std::move(held), std::move(experiment), std::move(observers)));
  catch_error([&] { take_back(*held, end, *trouble); });  // reports the first error, not an error of take_back()
  throw Error(*trouble);
}

Belief& Run::look(const QuantitySet& quantities) {
  const auto has_all = [&](const QuantitySet& some) {
    return std::includes(some.begin(), some.end(), quantities.begin(), quantities.end());
  };
  Belief& own = experiment_->belief();
  own.update();
  if (has_all(own.available())) {
    experiment_->look();
    return own;
  }
  // The copy is kept only after success, because an exception may leave a tap in the copy only partly processed.
  std::unique_ptr<Experiment> copy = std::move(copy_);
  if (!copy || !has_all(looked_at_)) {
    const QuantitySet wanted = looked_at_ | quantities;
    const ExperimentSetup setup{environment_->host,
                                environment_->interrupted,
                                no_backend(experiment_->backend().scene_is_truth()),
                                {},
                                readers_from_first_tap("display", wanted)};
    copy = std::make_unique<Experiment>(config_.options, setup);
    looked_at_ = wanted;
  }
  const std::vector<TapRecord> taps = read_taps(directory_->rows(), directory_->path());
  copy->resume({taps.begin() + copy->counts().taps, taps.end()});
  copy->look();
  copy_ = std::move(copy);
  return copy_->belief();
}

const RunConclusion& Run::run() {
  if (!is_finished()) end(failure_in([&] { experiment_->run(*recorder_); }));
  return *report_;
}

const TapRecord* Run::ask(const Eigen::VectorXd* scores) {
  if (is_finished()) return nullptr;
  if (tap_ && scores != nullptr)
    throw Error(fmt::format("tap {}", tap_->number()), "is pending", "call tell() with its result first");
  if (tap_) return &*tap_;
  const std::optional<TapOverride> override =
      scores != nullptr ? std::optional(TapOverride{*scores, {}}) : std::nullopt;
  const std::string failure = failure_in(
      [&] { tap_ = experiment_->begin(*recorder_, std::numeric_limits<int>::max(), override ? &*override : nullptr); });
  if (tap_ && failure.empty()) return &*tap_;
  end(failure);
  return nullptr;
}

void Run::tell(TapResult result) {
  if (!tap_) throw Error("tell", "no tap is pending", "call ask() first");
  const TapLine& line = tap_->request.line;
  complete_contact(line, result);
  if (const auto fault = find_fault(result, line, bounds_of(config_, *experiment_)))
    throw Error("tell", fault->reason, fault->remedy);
  result.reason = plain_line(result.reason);
  tap_->result = std::move(result);
  const std::string failure = failure_in([&] { experiment_->end(*tap_, *recorder_); });
  tap_.reset();
  if (!failure.empty()) end(failure);
}

const RunConclusion& Run::finish() {
  if (!is_finished()) {
    if (tap_) throw Error(fmt::format("tap {}", tap_->number()), "is pending", "call tell() with its result first");
    experiment_->stop("ended by the caller");
    end({});
  }
  return *report_;
}

/// Writes the end of the run. `failure` is the reason why the run failed, or "". If the run failed, throws Error after
/// everything is written.
void Run::end(std::string failure) {
  tap_.reset();
  RunConclusion& report = report_.emplace();  // a failed run is finished, too
  report.directory = directory_->path();
  RunResult result;
  if (failure.empty()) failure = failure_in([&] { result = experiment_->result(); });
  directory_->check_in_place();
  // After a failure, only the counts are used, because the models may fail again.
  if (!failure.empty()) result = experiment_->counts();
  for (const Backend::Learnt& one : experiment_->backend().learnt()) directory_->note_learnt(one.name, one.value);
  report.interrupted = result.interrupted;
  const Summary summary{
      result,          config_, failure, watch_.wall_seconds(), watch_.cpu_seconds(), directory_->total_seconds(),
      peak_rss_bytes()};
  report.summary = summary_list().row(summary);
  directory_->write_made(kTapsTable, to_csv(directory_->rows()));
  if (result.interrupted) {
    directory_->end({Ending::EndKind::interrupted, result.stop_reason, {}, {}});
    return;
  }
  if (config_.options.log.surface && failure.empty()) {
    const auto [name, text] = surface_file(*experiment_);
    directory_->write_made(name, text);
  }
  directory_->write_objects(object_rows(summary));
  directory_->end({failure.empty() ? Ending::EndKind::done : Ending::EndKind::failed,
                   failure.empty() ? result.stop_reason : failure,
                   report.summary,
                   {}});
  if (!failure.empty()) throw Error("", failure, {}, Error::Kind::run);
}

RunConclusion start_run(const RunEnvironment& environment, const ResolvedConfig& config, const fs::path& directory,
                        const StartOptions& options, const std::vector<Observer*>& observers) {
  return Run::start(environment, config, directory, options, observers)->run();
}

RunConclusion resume_run(const RunEnvironment& environment, const fs::path& directory, const ResumeOptions& options,
                         const std::vector<Observer*>& observers) {
  return Run::resume(environment, directory, options, observers)->run();
}

std::vector<PlannedModel> models_of(const RunEnvironment& environment, const ResolvedConfig& config) {
  const bool connects = config.options.backend.type != "simulator";  // any other backend may connect to a device
  return build_experiment(config, {environment.host, environment.interrupted, connects ? no_backend(false) : nullptr})
      ->plan()
      .models;
}

fs::path directory_of(const ResolvedConfig& config, const fs::path& runs) {
  return runs / slug(config.options.name) / config.id;
}

std::optional<Error> objection_to_build(const RunEnvironment& environment, const ResolvedConfig& config,
                                        const RunRecord& record) {
  const std::string build = record.build();
  if (build.empty() || build == build_hash(environment.host, config.notes.plugins) || record.taps.empty())
    return std::nullopt;
  return Error(record.file.parent_path().string(), "this run was started by another build of palpate or its plugins",
               "add --force to resume it with this build, which the record will note");
}

RestoredFiles restore_files(const RunEnvironment& environment, RunDirectory& held) {
  const fs::path& directory = held.path();
  const RunRecord& record = held.before();
  RestoredFiles out;
  const auto restore = [&](const Ending::ListedFile& one, const std::string& text) {
    const bool same = text.size() == one.bytes && hash_of(text) == one.hash;
    if (same) held.write(one.name, text);
    (same ? out.made : out.lost).push_back(one.name);
  };
  for (const Ending::ListedFile& one : record.end->files) {
    const std::optional<std::string> now = read_if_there(directory / one.name);
    if (now && now->size() == one.bytes && hash_of(*now) == one.hash) continue;
    if (one.name == kTapsTable) {
      restore(one, to_csv(record.taps));
      continue;
    }
    const RecordedRun run = read_recorded_run(environment.host, directory);
    RunReplay replay(environment, run);
    replay.advance_to(static_cast<int>(run.taps.size()));
    replay.experiment().result();  // reads the same models as the original run read at its end
    const auto [name, text] = surface_file(replay.experiment());
    restore(one, name == one.name ? text : "");
    const bool is_made = out.lost.empty() || out.lost.back() != one.name;
    if (!is_made && replay.truth_lost()) throw Error(*replay.truth_lost());
  }
  // The summary is written last, as in a run.
  const std::string summary = to_json(record.end->summary);
  if (read_if_there(directory / kSummaryFile) != summary) {
    held.write(kSummaryFile, summary);
    out.made.emplace_back(kSummaryFile);
  }
  return out;
}

}  // namespace palpate
