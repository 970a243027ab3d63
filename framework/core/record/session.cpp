// SPDX-License-Identifier: MIT
#include "record/session.hpp"

#include "config/yaml.hpp"
#include "experiment/experiment.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/recording.hpp"
#include "record/summary.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

std::string manifest_text(const Workshop& workshop, const ResolvedConfig& config, const Experiment& experiment) {
  Tree out = describe_build(workshop.installation, workshop.host, config.notes.plugins, loops_of(config.options).name);
  const auto places = [](const std::vector<ResolveNotes::Origin>& of) {
    Tree all = Tree::map();
    for (const ResolveNotes::Origin& one : of) all.entries.push_back({one.path, {}, Tree::quote(one.place)});
    return all;
  };
  Tree& line = out.at("command_line") = Tree::list();
  for (const std::string& word : workshop.command_line) line.items.push_back(Tree::quote(word));
  out.at("origins") = places(config.notes.origins);
  out.at("dropped") = places(config.notes.dropped);
  Tree& models = out.at("models") = Tree::map();
  for (const ModelReader& one : experiment.readers()) {
    Tree& who = models.at(one.model);
    who.kind = Tree::Kind::list;
    who.items.push_back(Tree::quote(one.who));
  }
  out.at("resumed") = Tree::list();
  return to_json(out);
}

/// The build that began the run in `directory`, "" if that is not known.
std::string recorded_build(const fs::path& directory) {
  if (!is_there(directory / "manifest.json")) return {};
  const Tree manifest = read_json(directory / "manifest.json");
  const Tree* build = manifest.find("build");
  return build != nullptr ? build->text : std::string();
}

/// Notes in the manifest that another process, perhaps of another build, went on at tap `from`.
void note_resume(const Workshop& workshop, const ResolvedConfig& config, const RunDirectory& directory, int from) {
  Tree manifest = read_json(directory.path() / "manifest.json");
  manifest.at("resumed").kind = Tree::Kind::list;
  manifest.at("resumed").items.push_back(
      Tree::map({{"after_tap", Tree::scalar(std::to_string(from))},
                 {"build", Tree::quote(build_hash(workshop.host, config.notes.plugins))}}));
  directory.write("manifest.json", to_json(manifest));
}

/// Notes in the manifest what the taps have shown of the robot.
void note_learnt(const RunDirectory& directory, const std::vector<Backend::Learnt>& learnt) {
  if (learnt.empty()) return;
  Tree manifest = read_json(directory.path() / "manifest.json");
  Tree& notes = manifest.at("learnt") = Tree::map();
  for (const Backend::Learnt& one : learnt) notes.entries.push_back({one.name, {}, Tree::quote(one.value)});
  directory.write("manifest.json", to_json(manifest));
}

void move_away(const fs::path& directory) {
  for (int n = 1;; ++n) {
    const fs::path old = directory.string() + fmt::format(".old-{}", n);
    if (fs::exists(old)) continue;
    fs::rename(directory, old);
    return;
  }
}

/// Who follows a run while it goes on; each may be null.
struct Company {
  Journal* observer;
  Supervisor* supervisor;
};

/// Asks the supervisor, passes taps to the record first and to the observer after it, and writes maps where the config
/// asks for them.
class Relay final : public Journal {
 public:
  Relay(const ExperimentOptions& options, Experiment& experiment, RunDirectory& directory, const Company& company)
      : maps_(options.log.maps), experiment_(experiment), directory_(directory), company_(company) {}

  bool permits(const TapRecord& tap) override {
    return company_.supervisor == nullptr || company_.supervisor->permits(tap, experiment_.preview(tap));
  }

  void announce(const TapRecord& tap) override {
    if (company_.observer != nullptr && company_.observer->wants_errors()) look_at_errors();
    {
      const PhaseClock::Scope log(experiment_.clock(), Phase::log);
      if (maps_) write_maps(tap.number);
      directory_.announce(tap);
    }
    if (company_.observer != nullptr) company_.observer->announce(tap);
  }

  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override {
    {
      const PhaseClock::Scope log(experiment_.clock(), Phase::log);
      directory_.record(tap, seconds);
    }
    if (company_.observer == nullptr) return;
    TapRecord told = tap;
    told.errors = errors_;
    company_.observer->record(told, seconds);
  }

 private:
  /// Before the tap is announced, and without a say in the run: a model that fails here fails nobody who reads it.
  void look_at_errors() {
    try {
      errors_ = experiment_.errors();
    } catch (const std::exception&) {  // see above
      errors_ = {};
    }
  }

  void write_maps(int number) const {
    const std::string text = maps_csv(experiment_);
    if (text.empty()) return;
    make_inner_folder(directory_.path() / "maps");
    directory_.write(fmt::format("maps/tap_{:03}.csv", number), text);
  }

  bool maps_;
  Experiment& experiment_;
  RunDirectory& directory_;
  Company company_;
  Errors errors_;  ///< of the state that the tap under way was chosen from, for the observer
};

/// Builds the experiment. What only building finds out names an option; the config knows where that was written.
std::unique_ptr<Experiment> build_experiment(const Workshop& workshop, const ResolvedConfig& config,
                                             const fs::path& directory) {
  try {
    return std::make_unique<Experiment>(config.options, workshop.host, workshop.interrupted, nullptr,
                                        directory.string());
  } catch (const Error& trouble) {  // thrown on, with the place that only the config knows
    const std::string place = config.tree.place_of(trouble.where()).text();
    if (place.empty()) throw;
    throw Error(place, trouble.where() + ": " + trouble.reason(), trouble.hint(), trouble.kind());
  }
}

/// Throws Error where a person would be asked of taps that put nothing at risk.
void check_worth_asking(const ResolvedConfig& config, const Experiment& experiment) {
  if (!experiment.backend().repeatable()) return;
  throw Error("command line",
              fmt::format("--step: the taps of backend {} can be repeated, there is nothing to confirm",
                          config.options.backend.type),
              "leave it out");
}

/// A run in a directory that this process holds, from its first tap here to what ends it.
class Course {
 public:
  Course(const ResolvedConfig& config, RunDirectory& directory, Experiment& experiment, const Company& company,
         const Stopwatch& watch)
      : config_(config),
        directory_(directory),
        experiment_(experiment),
        watch_(watch),
        relay(config.options, experiment, directory, company) {
    const LogOptions& log = config.options.log;
    const bool once = !experiment.backend().repeatable();  // then a tap of which nobody saw the end must leave a trace
    directory.open(once, log.sync == LogOptions::Sync::tap || (once && log.sync != LogOptions::Sync::none));
  }

  /// Goes on with the run by `part`, and says of an exception why the run ends with it; "" if there was none.
  template <class Part>
  static std::string failure_in(const Part& part) {
    try {
      part();
      return {};
    } catch (const std::exception& trouble) {
      return trouble.what();
    } catch (...) {
      return "a plugin threw something that is no exception";
    }
  }

  /// Writes what ends a run. `failure`: why it did not end well, else "".
  RunReport finish(std::string failure) {
    RunResult result;
    if (failure.empty()) failure = failure_in([&] { result = experiment_.result(); });
    directory_.check_in_place();
    // A model that failed once is not asked again.
    if (!failure.empty()) result = experiment_.counts();
    note_learnt(directory_, experiment_.backend().learnt());
    RunReport report;
    report.directory = directory_.path();
    report.interrupted = result.interrupted;
    const Summary summary{
        result,          config_, failure, watch_.wall_seconds(), watch_.cpu_seconds(), directory_.total_seconds(),
        peak_rss_bytes()};
    report.summary = summary_list().row(summary);
    directory_.write("taps.csv", to_csv(directory_.rows()));
    if (result.interrupted) return report;
    if (config_.options.log.surface && failure.empty()) directory_.write("surface.csv", surface_csv(experiment_));
    if (const std::string objects = objects_csv(summary); !objects.empty()) directory_.write("objects.csv", objects);
    directory_.write("summary.json", to_json_text(report.summary));
    if (!failure.empty()) throw Error("", failure, {}, Error::Kind::run);
    return report;
  }

 private:
  const ResolvedConfig& config_;
  RunDirectory& directory_;
  Experiment& experiment_;
  const Stopwatch& watch_;

 public:
  Relay relay;  ///< who hears of its taps
};

/// Runs the experiment in an open directory and writes what ends a run.
RunReport carry_out(const ResolvedConfig& config, RunDirectory& directory, Experiment& experiment,
                    const Company& company, const Stopwatch& watch) {
  Course course(config, directory, experiment, company, watch);
  return course.finish(Course::failure_in([&] { experiment.run(course.relay); }));
}

RunReport report_done(const fs::path& directory) { return {directory, true, false, read_summary(directory).value()}; }

/// An experiment, and the directory for its record; neither where the directory has the finished run.
struct Begun {
  std::unique_ptr<RunDirectory> directory;
  std::unique_ptr<Experiment> experiment;
};

Begun begin_run(const Workshop& workshop, const ResolvedConfig& config, const fs::path& directory, bool force,
                bool supervised) {
  const RunStatus status = read_status(directory);
  if (status.state == RunStatus::State::running) FileLock{directory / "lock"};  // throws: busy
  if (status.state != RunStatus::State::absent && !force) {
    const std::string where = directory.string();
    switch (status.state) {
      case RunStatus::State::done:
        if (recorded_build(directory) == build_hash(workshop.host, config.notes.plugins)) return {};
        throw Error(where, "this run was finished by another build of palpate or its plugins",
                    "--force moves it aside and runs again");
      case RunStatus::State::failed:
        throw Error(where, fmt::format("this run failed: {}", status.stop_reason),
                    "'palpate resume --retry-failed' carries on, --force starts again");
      default:
        throw Error(where, fmt::format("this run was broken off after {} taps", status.taps),
                    "'palpate resume' carries on, --force starts again");
    }
  }
  // Built before the directory is touched: what only building finds out leaves no trace.
  std::unique_ptr<Experiment> experiment = build_experiment(workshop, config, directory);
  if (supervised) check_worth_asking(config, *experiment);
  if (status.state != RunStatus::State::absent) move_away(directory);
  auto held = std::make_unique<RunDirectory>(directory);
  // Another process may have run it, whole or in part, while this one was still building.
  if (read_record(directory).state != RunStatus::State::absent) {
    throw Error(directory.string(), "another process has just run this", "run it again to see how it ended",
                Error::Kind::busy);
  }
  held->write("config.yaml", to_yaml(config.tree));
  held->write("manifest.json", manifest_text(workshop, config, *experiment));
  return {std::move(held), std::move(experiment)};
}

enum class Taps { by_backend, by_caller };

/// Throws Error where the taps of a run are made by somebody else. `command`: of the program, that was to make them.
void check_who_taps(const ResolvedConfig& config, Taps taps, const std::string& command) {
  const std::string& backend = config.options.backend.type;
  const bool by_caller = backend == kCaller;
  if (by_caller == (taps == Taps::by_caller)) return;
  if (by_caller) {
    throw Error("backend", "the taps of this run are made by a program of somebody's own, not by palpate",
                command == "run" ? "palpate.Experiment(...) in Python asks for them, or choose another backend"
                                 : "palpate.Experiment.resume(DIR) in Python carries it on");
  }
  throw Error("backend", fmt::format("the taps of this run are made by backend {}, not by a caller", backend),
              command == "run" ? "choose the backend caller" : "'palpate resume' carries it on");
}

}  // namespace

std::vector<ModelReader> readers_of(const Workshop& workshop, const ResolvedConfig& config) {
  const bool is_robot = workshop.host.one_at_a_time({{Backend::kKind, config.options.backend.type}});
  return Experiment(config.options, workshop.host, workshop.interrupted, is_robot ? no_backend(false) : nullptr)
      .readers();
}

fs::path directory_of(const ResolvedConfig& config, const fs::path& runs) {
  return runs / slug(config.options.name) / config.id;
}

RunReport start_run(const Workshop& workshop, const ResolvedConfig& config, const fs::path& directory, bool force,
                    Journal* observer, Supervisor* supervisor) {
  check_who_taps(config, Taps::by_backend, "run");
  const Stopwatch watch;
  const Begun run = begin_run(workshop, config, directory, force, supervisor != nullptr);
  if (!run.experiment) return report_done(directory);
  return carry_out(config, *run.directory, *run.experiment, {observer, supervisor}, watch);
}

Tree read_run_config(const fs::path& directory) {
  const fs::path file = directory / "config.yaml";
  if (!is_there(file)) throw Error(directory.string(), "is not a run directory", "it has no config.yaml");
  Tree config = read_yaml(file);
  check_format(config);
  return config;
}

ResolvedConfig load_run(const PluginHost& host, const fs::path& directory) {
  ResolvedConfig config = resolve_experiment(read_run_config(directory), host);
  const std::string name = fs::absolute(directory).lexically_normal().filename().string();
  if (begins_with_id(name) && name.substr(0, kIdLength) != config.id) {
    throw Error((directory / "config.yaml").string(),
                fmt::format("the config now has the id {}, its directory is {}", config.id, name),
                "config.yaml was changed; run it with 'palpate run' instead");
  }
  return config;
}

std::optional<Error> objection_to_build(const Workshop& workshop, const ResolvedConfig& config,
                                        const fs::path& directory) {
  const std::string build = recorded_build(directory);
  if (build.empty() || build == build_hash(workshop.host, config.notes.plugins)) return std::nullopt;
  if (read_record(directory).taps == 0) return std::nullopt;
  return Error(directory.string(), "this run was begun by another build of palpate or its plugins",
               "--force carries on all the same, and the manifest will say so");
}

RunReport resume_run(const Workshop& workshop, const fs::path& directory, const ResumeOptions& options,
                     Journal* observer, Supervisor* supervisor) {
  // Read first: what is no run directory is not made one.
  const ResolvedConfig config = load_run(workshop.host, directory);
  RunDirectory held(directory);
  return resume_held(workshop, config, held, options, observer, supervisor);
}

namespace {

/// The experiment as it was after the recorded taps of a directory that this process holds; none where the run is done.
std::unique_ptr<Experiment> go_on(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                                  const ResumeOptions& options, Taps taps, bool supervised) {
  const fs::path& directory = held.path();
  const RunStatus status = read_record(directory);
  if (status.state == RunStatus::State::done) return nullptr;
  check_who_taps(config, taps, "resume");
  if (status.state == RunStatus::State::failed && !options.retry_failed) {
    throw Error(directory.string(), fmt::format("this run failed: {}", status.stop_reason),
                "--retry-failed carries on all the same", Error::Kind::run);
  }
  const auto objection = options.force ? std::nullopt : objection_to_build(workshop, config, directory);
  if (objection) throw *objection;
  const std::vector<PastTap> past = held.recover();
  std::unique_ptr<Experiment> experiment = build_experiment(workshop, config, directory);
  if (supervised) check_worth_asking(config, *experiment);
  experiment->resume(past);
  if (recorded_build(directory).empty()) {
    held.write("manifest.json", manifest_text(workshop, config, *experiment));
  } else {
    note_resume(workshop, config, held, static_cast<int>(past.size()));
  }
  std::error_code none;
  fs::remove(directory / "summary.json", none);
  return experiment;
}

/// The one CallersRun: what is begun or carried on, whichever, goes on alike.
class Held final : public CallersRun {
 public:
  Held(const ResolvedConfig& config, Begun begun)
      : config_(config),
        begun_(std::move(begun)),
        course_(config_, *begun_.directory, *begun_.experiment, {}, watch_) {}

  const TapRecord* begin(const Eigen::VectorXd* scores) override {
    if (finished()) return nullptr;
    if (tap_ && scores != nullptr) {
      throw Error(fmt::format("tap {}", tap_->number), "is asked for already", "tell first what came of it");
    }
    if (tap_) return &*tap_;
    const std::optional<Wish> wish = scores != nullptr ? std::optional(Wish{*scores, {}}) : std::nullopt;
    const std::string failure = Course::failure_in([&] {
      tap_ = begun_.experiment->begin(course_.relay, std::numeric_limits<int>::max(), wish ? &*wish : nullptr);
    });
    if (tap_ && failure.empty()) return &*tap_;
    end_with(failure);
    return nullptr;
  }

  void end(Contact contact) override {
    if (!tap_) throw Error("tell", "no tap is asked for", "ask first where to tap");
    tap_->contact = std::move(contact);
    const std::string failure = Course::failure_in([&] { begun_.experiment->end(*tap_, course_.relay); });
    tap_.reset();
    if (!failure.empty()) end_with(failure);
  }

  const RunReport& finish() override {
    if (!finished()) {
      if (tap_) throw Error(fmt::format("tap {}", tap_->number), "is asked for", "tell first what came of it");
      begun_.experiment->stop("ended by the caller");
      end_with({});
    }
    return *report_;
  }

  bool finished() const override { return report_.has_value(); }
  Experiment& experiment() override { return *begun_.experiment; }
  const ResolvedConfig& config() const override { return config_; }
  const fs::path& directory() const override { return begun_.directory->path(); }

 private:
  /// A run that failed is finished as well.
  void end_with(const std::string& failure) {
    tap_.reset();
    report_.emplace();
    report_->directory = directory();
    *report_ = course_.finish(failure);
  }

  Stopwatch watch_;
  ResolvedConfig config_;
  Begun begun_;
  Course course_;
  std::optional<TapRecord> tap_;  ///< that is to be made
  std::optional<RunReport> report_;
};

/// What is said of a run that is there already.
Error finished_error(const fs::path& directory) {
  return Error(directory.string(), "this run is finished", "force moves it aside and runs again");
}

}  // namespace

std::unique_ptr<CallersRun> CallersRun::start(const Workshop& workshop, const ResolvedConfig& config,
                                              const fs::path& directory, bool force) {
  check_who_taps(config, Taps::by_caller, "run");
  Begun begun = begin_run(workshop, config, directory, force, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<Held>(config, std::move(begun));
}

std::unique_ptr<CallersRun> CallersRun::resume(const Workshop& workshop, const fs::path& directory,
                                               const ResumeOptions& options) {
  const ResolvedConfig config = load_run(workshop.host, directory);
  Begun begun;
  begun.directory = std::make_unique<RunDirectory>(directory);
  begun.experiment = go_on(workshop, config, *begun.directory, options, Taps::by_caller, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<Held>(config, std::move(begun));
}

RunReport resume_held(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                      const ResumeOptions& options, Journal* observer, Supervisor* supervisor) {
  const Stopwatch watch;
  const std::unique_ptr<Experiment> experiment =
      go_on(workshop, config, held, options, Taps::by_backend, supervisor != nullptr);
  if (!experiment) return report_done(held.path());
  return carry_out(config, held, *experiment, {observer, supervisor}, watch);
}

}  // namespace palpate
