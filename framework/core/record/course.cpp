// SPDX-License-Identifier: MIT
#include "record/course.hpp"

#include "config/catch_error.hpp"
#include "config/yaml.hpp"
#include "math/instructions.hpp"
#include "record/callers_run.hpp"
#include "record/fields.hpp"
#include "record/recording.hpp"

#include <fmt/format.h>

#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// What is known before anything is built.
Tree manifest_of(const Workshop& workshop, const ResolvedConfig& config) {
  Tree out = Tree::map(
      {{"name", Tree::quote(config.options.name)}, {"id", Tree::quote(config.id)}, {"at", Tree::quote(now_text())}});
  const Tree build = describe_build(workshop.installation, workshop.host, config.notes.plugins,
                                    math::name_of(math::choose_instructions()));
  out.entries.insert(out.entries.end(), build.entries.begin(), build.entries.end());
  const auto places = [](const std::vector<ResolveNotes::Origin>& of) {
    Tree all = Tree::map();
    for (const ResolveNotes::Origin& one : of) all.entries.push_back({one.path, {}, Tree::quote(one.place)});
    return all;
  };
  out.at("identity") = Tree::quote(config.identity);
  Tree& line = out.at("command_line") = Tree::list();
  for (const std::string& word : workshop.command_line) line.items.push_back(Tree::quote(word));
  out.at("dropped") = places(config.notes.dropped);
  return out;
}

/// Notes that the experiment is built; a tap that cannot be repeated, and of which nobody saw the end, must leave a
/// trace.
void set_up(const Experiment& experiment, RunDirectory& directory) {
  Tree models = Tree::map();
  for (const ModelReader& one : experiment.readers()) {
    Tree& who = models.at(one.model);
    who.kind = Tree::Kind::list;
    who.items.push_back(Tree::quote(one.who));
  }
  directory.set_up(!experiment.backend().repeatable(), models);
}

/// Has what follows forced to disk where the config or the backend asks for it.
void sync_if_asked(const ResolvedConfig& config, const Experiment& experiment, RunDirectory& directory) {
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

/// Builds the experiment. What only building finds out names an option; the config knows where that was written.
std::unique_ptr<Experiment> build_experiment(const Workshop& workshop, const ResolvedConfig& config,
                                             const fs::path& directory) {
  try {
    return make_experiment(config.options, workshop.host, workshop.interrupted, nullptr, directory.string());
  } catch (const Error& trouble) {  // thrown on, with the place that only the config knows
    const std::string place = config.tree.place_of(trouble.where()).text();
    if (place.empty()) throw;
    throw Error(place, trouble.where() + ": " + trouble.reason(), trouble.hint(), trouble.kind());
  }
}

/// Of a run that could not be carried on as far as it had come: one that had failed has failed for the same reason, and
/// one whose arm another process moves was only tried.
void take_back(RunDirectory& held, const std::optional<Ending>& before, const Error& trouble) {
  if (before && before->how == Ending::How::failed) {
    held.end(*before);
  } else if (trouble.kind() == Error::Kind::busy) {
    held.end({Ending::How::interrupted, trouble.what(), {}, {}});
  }
}

/// Throws Error where a person would be asked of taps that put nothing at risk.
void check_worth_asking(const ResolvedConfig& config, const Experiment& experiment) {
  if (!experiment.backend().repeatable()) return;
  throw Error("command line",
              fmt::format("--step: the taps of backend {} can be repeated and need no confirmation",
                          config.options.backend.type),
              "leave it out");
}

}  // namespace

RecordedRun recorded_run(const fs::path& directory) {
  RecordedRun out;
  // A damaged one is told of by who needs it.
  catch_error([&] {
    const std::optional<Tree> manifest = read_manifest(directory);
    if (const Tree* name = manifest ? manifest->find("name") : nullptr) out.name = name->text;
    if (const Tree* identity = manifest ? manifest->find("identity") : nullptr) out.identity = identity->text;
  });
  return out;
}

bool Course::permits(const TapRecord& tap) {
  return supervisor_ == nullptr || supervisor_->permits(tap, experiment_.preview(tap));
}

void Course::announce(const TapRecord& tap) {
  if (observer_ != nullptr && observer_->wants_errors()) look_at_surface();
  {
    const PhaseClock::Scope log(experiment_.clock(), Phase::log);
    if (config_.options.log.maps) write_maps(tap.number);
    directory_.announce(tap);
  }
  if (observer_ != nullptr) observer_->announce(tap);
}

void Course::record(const TapRecord& tap, const std::array<double, kPhases>& seconds) {
  TapRecord told = tap;
  told.expected_rmse = expected_rmse_;  // stands with the times, not with the tap
  {
    const PhaseClock::Scope log(experiment_.clock(), Phase::log);
    directory_.record(told, seconds);
  }
  if (observer_ == nullptr) return;
  told.errors = errors_;
  observer_->record(told, seconds);
}

/// Before the tap is announced, and without a say in the run: a model that fails here fails nobody who reads it.
void Course::look_at_surface() {
  errors_ = {};
  expected_rmse_.reset();
  try {
    errors_ = experiment_.errors();
    expected_rmse_ = experiment_.expected_rmse();
  } catch (const std::exception&) {  // see above
  }
}

void Course::write_maps(int number) const {
  const auto* const above = dynamic_cast<const FromAbove*>(&experiment_);
  const std::string text = above != nullptr ? maps_csv(*above) : std::string();
  if (text.empty()) return;
  make_inner_folder(directory_.path() / "maps");
  directory_.write(fmt::format("maps/tap_{:03}.csv", number), text);
}

RunReport Course::finish(std::string failure) {
  RunResult result;
  if (failure.empty()) failure = failure_in([&] { result = experiment_.result(); });
  directory_.check_in_place();
  // A model that failed once is not asked again.
  if (!failure.empty()) result = experiment_.counts();
  for (const Backend::Learnt& one : experiment_.backend().learnt()) directory_.note_learnt(one.name, one.value);
  RunReport report;
  report.directory = directory_.path();
  report.interrupted = result.interrupted;
  const Summary summary{
      result,          config_, failure, watch_.wall_seconds(), watch_.cpu_seconds(), directory_.total_seconds(),
      peak_rss_bytes()};
  report.summary = summary_list().row(summary);
  directory_.write_made(kTapsTable, to_csv(directory_.rows()));
  if (result.interrupted) {
    directory_.end(Ending::How::interrupted, result.stop_reason, {});
    return report;
  }
  if (config_.options.log.surface && failure.empty()) {
    const auto [name, text] = surface_file(experiment_);
    directory_.write_made(name, text);
  }
  directory_.write_objects(object_rows(summary));
  directory_.end(failure.empty() ? Ending::How::done : Ending::How::failed,
                 failure.empty() ? result.stop_reason : failure, report.summary);
  if (!failure.empty()) throw Error("", failure, {}, Error::Kind::run);
  return report;
}

Begun begin_run(const Workshop& workshop, const ResolvedConfig& config, const fs::path& directory, bool force,
                bool supervised) {
  if (is_running(directory)) FileLock{directory / kRecordFile};  // throws: busy
  RunStatus status;
  if (const auto trouble = catch_error([&] { status = read_record(directory); })) {
    // What cannot be read can be moved aside.
    if (!force || trouble->kind() != Error::Kind::usage) throw Error(*trouble);
    status.state = RunStatus::State::unfinished;
  }
  if (status.state != RunStatus::State::absent && !force) {
    const std::string where = directory.string();
    const RecordedRun other = recorded_run(directory);
    const bool has_name = other.name.empty() || other.name == config.options.name;
    if (!has_name || (!other.identity.empty() && other.identity != config.identity)) {
      throw Error(where,
                  has_name ? fmt::format("the folder contains another run with the id {}", config.id)
                           : fmt::format("the folder contains a run with the name '{}'", other.name),
                  "give this run another name");
    }
    switch (status.state) {
      case RunStatus::State::done:
        if (read_run_record(directory).build() == build_hash(workshop.host, config.notes.plugins)) return {};
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
  // Built before the directory is touched: what only building finds out leaves no trace.
  std::unique_ptr<Experiment> experiment = build_experiment(workshop, config, directory);
  if (supervised) check_worth_asking(config, *experiment);
  if (status.state != RunStatus::State::absent) {
    const FileLock old(directory / kRecordFile);  // somebody may have taken it up meanwhile
    move_away(directory);
  }
  auto held = std::make_unique<RunDirectory>(directory);
  // Another process may have run it, whole or in part, while this one was still building.
  if (read_record(directory).state != RunStatus::State::absent) {
    throw Error(directory.string(), "another process has just finished this run",
                "repeat the command to see how it ended", Error::Kind::busy);
  }
  sync_if_asked(config, *experiment, *held);
  held->write_config(to_yaml_with_places(config.tree));
  held->begin(manifest_of(workshop, config));
  held->begin_attempt(build_hash(workshop.host, config.notes.plugins), force);
  set_up(*experiment, *held);
  return {std::move(held), std::move(experiment)};
}

std::unique_ptr<Experiment> go_on(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                                  const ResumeOptions& options, Taps taps, bool supervised) {
  const fs::path& directory = held.path();
  const RunRecord& before = held.before();
  const std::optional<Ending> end = before.end;
  if (end && end->how == Ending::How::done) return nullptr;
  check_who_taps(config, taps, "resume");
  if (end && end->how == Ending::How::failed && !options.retry_failed) {
    throw Error(directory.string(), fmt::format("this run failed: {}", end->reason), "resume it with --retry-failed",
                Error::Kind::run);
  }
  const auto objection = options.force ? std::nullopt : objection_to_build(workshop, config, before);
  if (objection) throw *objection;
  // What it says does not hold any more, or is of a record that was cut.
  std::error_code none;
  fs::remove(directory / kSummaryFile, none);
  if (before.is_failure_alone()) held.clear();
  if (!before.manifest) held.begin(manifest_of(workshop, config));
  held.begin_attempt(build_hash(workshop.host, config.notes.plugins), options.force);
  std::unique_ptr<Experiment> experiment;
  const std::optional<Error> trouble = catch_error([&] {
    experiment = build_experiment(workshop, config, directory);
    if (supervised) check_worth_asking(config, *experiment);
    sync_if_asked(config, *experiment, held);
    set_up(*experiment, held);
    experiment->resume(held.recover());
  });
  if (!trouble) return experiment;
  catch_error([&] { take_back(held, end, *trouble); });  // the first one counts
  throw Error(*trouble);
}

void check_who_taps(const ResolvedConfig& config, Taps taps, const std::string& command) {
  const std::string& backend = config.options.backend.type;
  const bool by_caller = backend == kCaller;
  if (by_caller == (taps == Taps::by_caller)) return;
  if (by_caller) {
    throw Error("backend", "the taps of this run are made by the caller's own program, not by palpate",
                command == "run" ? "run it with palpate.Experiment(...) in Python, or choose another backend"
                                 : "resume it with palpate.Experiment.resume(DIR) in Python");
  }
  throw Error("backend", fmt::format("the taps of this run are made by backend {}, not by a caller", backend),
              command == "run" ? "choose the backend caller" : "resume it with 'palpate resume'");
}

}  // namespace palpate
