// SPDX-License-Identifier: MIT
#include "cli/tune.hpp"

#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "cli/sweep_execution.hpp"
#include "launch/job.hpp"
#include "launch/parallel_children.hpp"
#include "record/files.hpp"
#include "sweep/draft.hpp"
#include "tune/race_report.hpp"
#include "tune/tuner.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/replace.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Assumed number of jobs of a race whose budget is a time, if no run can be timed before the race.
constexpr std::size_t kJobsOfTime = 250;
constexpr double kMostJobs = 1e6;  ///< limit for budgets in time
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

TuneWords words_of(const TuneArguments& arguments) {
  TuneWords out{arguments.keys, arguments.scenes, {}};
  const auto set = [&](const char* name, const auto& value) {
    if (value) out.settings.emplace_back(name, fmt::format("{}", *value));
  };
  set("metric", arguments.metric);
  set("cost", arguments.cost);
  set("jobs", arguments.jobs);
  set("time", arguments.time);
  set("within", arguments.within);
  set("fresh", arguments.fresh);
  if (arguments.where) set("where", std::optional("'" + boost::replace_all_copy(*arguments.where, "'", "''") + "'"));
  return out;
}

/// Makes the first runs of the config as it stands, until one has a value of the metric. The runs remain in the draft.
/// Returns the wall time per run. Throws Error if no run has a value.
double try_metric(const CommandEnvironment& program, const TunePlanner& planner, SweepDraft& draft) {
  const TuneDescription& description = planner.description();
  const PlannedSetting own{SettingValues(description.keys.size()), 0, kFirstSeeds};
  const std::vector<Job> jobs =
      planner.plan({own}, 0, false, [&](const Job& job, const ResolvedConfig& config) { draft.add(job, config); });
  const Clock::time_point begin = Clock::now();
  std::string reason;
  for (std::size_t seed = 0; seed < jobs.size(); ++seed) {
    const fs::path directory = draft.job_directory(jobs[seed]);
    if (!in_children(
            1, 1, [&](std::size_t) { run_job(program, directory, {}); }, program.interrupted, nullptr))
      return 0.0;
    const std::optional<Row> summary = read_outcome(directory);
    if (summary && summary->number(description.metric)) return seconds_since(begin) / static_cast<double>(seed + 1);
    if (summary && summary->text("status") != "done") reason = summary->text("stop_reason");
  }
  const RecordField* field = find_summary_field(description.metric);
  if (reason.empty() && field != nullptr) reason = field->when_null;
  throw Error(description.written.find("metric")->place.text(),
              fmt::format("tune: the first {} runs of the config have no value of '{}'{}", jobs.size(),
                          description.metric, reason.empty() ? "" : ": " + reason),
              "tune another metric, or change the config");
}

/// Returns the number of jobs of the whole race, from `jobs` that took `seconds`.
std::size_t budget_of(const TuneDescription& description, std::size_t jobs, double seconds) {
  if (description.jobs) return *description.jobs;
  const double all = static_cast<double>(jobs) * *description.seconds / std::max(seconds, 1e-3);
  return static_cast<std::size_t>(std::min(all, kMostJobs));
}

/// Shows the state of the race, without a rate: the race may end before its budget is used.
void show_race(SweepLine& line, const RaceRecord& race) {
  SweepProgress progress;
  progress.jobs = static_cast<int>(race.state.budget);
  progress.done = static_cast<int>(race.race_jobs);
  progress.running = 1;
  progress.before = progress.done;
  progress.last = race.has_ended();
  line.show(progress, fmt::format("{} of {} runs, {} of {} settings in the race, on {} seeds", race.race_jobs,
                                  race.state.budget, race.state.racing.size(), race.settings.size(), race.state.seeds));
}

/// Throws Error for options of the launch that a race does not take.
void check_race_launch(const TuneDescription& description, const LaunchArguments& launch) {
  if (!launch.junit.empty()) throw Error("command line", "--junit: a race has no expectations", "leave it out");
  if (description.seconds && is_cluster(launch.launcher) && !launch.wait)
    throw Error("command line", "--time: a race on a cluster cannot measure its time", "give --jobs, or add --wait");
}

/// Returns the words with which a cluster continues the race after a round.
std::vector<std::string> next_command(const fs::path& directory, const LaunchArguments& launch,
                                      const ResumeOptions& options) {
  if (!is_cluster(launch.launcher)) return {};
  std::vector<std::string> out{"resume",     fs::absolute(directory).string(), "--launcher", launch.launcher,
                               "--attempts", std::to_string(launch.attempts)};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) out.insert(out.end(), {name, value});
  };
  add("-j", launch.workers ? std::to_string(*launch.workers) : "");
  add("--partition", launch.cluster.partition);
  add("--task-time", launch.cluster.time);
  add("--account", launch.cluster.account);
  add("--jobs-per-task", launch.jobs_per_task ? std::to_string(*launch.jobs_per_task) : "");
  for (const std::string& word : launch.cluster.words) out.push_back("--sbatch=" + word);
  if (options.force) out.emplace_back("--force");
  return out;
}

/// Throws Error if a cluster executes this process after jobs of which none has ended, because it would submit them
/// forever.
void check_progress(const Sweep& sweep, const JobStates& begun) {
  const char* const before = std::getenv(kEndedJobs);
  if (before == nullptr || begun.open.empty() ||
      sweep.jobs.size() - begun.open.size() > std::strtoull(before, nullptr, 10))
    return;
  const std::string directory = fs::absolute(sweep.directory).string();
  throw Error(directory, "no job of the last submission has ended, so the race stops",
              fmt::format("read the logs in its folder slurm, then run: palpate resume {} --launcher slurm", directory),
              Error::Kind::run);
}

/// Prints the results, and writes results.csv, race.csv and best.yaml.
void print_race(const RaceResults& results) {
  const fs::path& directory = results.sweep.directory;
  write_results(results.sweep);
  write_file(directory / "race.csv", to_csv(race_rows(results)));
  print_text(race_text(results));
  for (std::size_t i = 0; i < results.best.size(); ++i) {
    const fs::path file = directory / (results.description.cost ? fmt::format("front_{}.yaml", i + 1) : "best.yaml");
    write_file(file, config_of_setting(results, results.best[i]));
    print_out("{}: {}\n", results.description.cost ? "on the front" : "best setting", file.string());
  }
}

}  // namespace

int run_race(CommandEnvironment& program, const fs::path& directory, const LaunchArguments& launch,
             const ResumeOptions& options) {
  const Tree config = read_run_config(directory);
  const TuneDescription description(config.find("tune"), {});
  const TunePlanner planner(program.composer, program.host, directory / "config.yaml", description);
  check_race_launch(description, launch);
  RaceValues values;
  SweepLine line(launch.quiet);
  LaunchArguments silent = launch;
  silent.quiet = true;  // The line shows the race, not the jobs of a round.
  bool has_begun = false;
  const Sweep recorded = read_sweep(directory);
  const RaceRecord before = read_race(recorded, description);
  replace_lost(planner, recorded, before);
  const Clock::time_point begin = Clock::now();
  for (;;) {
    const Sweep sweep = read_sweep(directory);
    const RaceRecord race = read_race(sweep, description);
    show_race(line, race);
    const bool one_at_a_time = program.host.one_at_a_time(planner.own().notes.plugins);
    SweepExecution execution{program, sweep,         options, silent,
                             {},      one_at_a_time, {},      next_command(directory, launch, options)};
    std::vector<std::size_t> jobs = all_jobs(sweep);
    jobs.erase(jobs.begin(), jobs.begin() + static_cast<std::ptrdiff_t>(values.metric.size()));
    JobStates begun = read_job_states(sweep, jobs);
    if (!has_begun) {
      check_builds(execution, jobs_not_done(begun));
      begin_execution(execution);
      check_progress(sweep, begun);
    }
    if (options.retry_failed && !has_begun) reopen_failed(begun);
    has_begun = true;
    const LaunchOutcome launched = launch_open(execution, begun);
    if (launched == LaunchOutcome::submitted) return kDone;
    const JobStates end = read_job_states(sweep, jobs, JobCheck::nothing);
    if (program.interrupted->load() || !end.open.empty() || launched != LaunchOutcome::ended) {
      print_failures(sweep, end.failures);
      print_out("resume with: palpate resume {}\n", directory.string());
      return program.interrupted->load() ? kInterrupted : kFailed;
    }
    const double seconds = before.seconds + seconds_since(begin);
    if (add_round(planner, directory, sweep.rounds.size(), budget_of(description, race.race_jobs, seconds), seconds,
                  values))
      continue;
    print_race({sweep, description, race, values});
    set_record_line("record: " + directory.string());
    print_out("record: {}\n", directory.string());
    return kDone;
  }
}

int tune(CommandEnvironment& program, const TuneArguments& arguments) {
  check_launch(arguments.launch);
  const LauncherType& launcher = checked_launcher(arguments.launch);
  if (launcher.check_installed != nullptr) launcher.check_installed();
  const Tree composed = program.composer.compose(program.composer.found(arguments.config), {});
  const TuneDescription description(composed.find("tune"), words_of(arguments));
  const TunePlanner planner(program.composer, program.host, arguments.config, description);
  check_taps_are_own(planner.own(), "backend");
  check_race_launch(description, arguments.launch);
  const fs::path directory = race_directory(planner, arguments.runs);
  if (is_sweep(directory)) {
    if (!arguments.launch.quiet) print_message(fmt::format("{} exists: the race goes on\n", directory.string()));
    return run_race(program, directory, arguments.launch, {});
  }
  listen_for_interrupts();
  std::optional<SweepDraft> draft(arguments.runs);
  double seconds = 0.0;
  // An arm moves only for the race itself, and the jobs of a cluster do not run on its login node.
  if (!is_cluster(arguments.launch.launcher) && !program.host.one_at_a_time(planner.own().notes.plugins))
    seconds = try_metric(program, planner, *draft);
  if (program.interrupted->load()) return kInterrupted;
  const int workers = arguments.launch.workers.value_or(cores());
  const std::size_t budget = seconds > 0.0 ? budget_of(description, static_cast<std::size_t>(workers), seconds)
                                           : description.jobs.value_or(kJobsOfTime);
  const SweepPlan plan =
      plan_first_round(planner, budget, arguments.runs, [&](const Job& job, const ResolvedConfig& config) {
        if (!is_there(draft->job_directory(job))) draft->add(job, config);
      });
  draft->publish(plan);
  draft.reset();  // releases the lock of the sweep
  if (!arguments.launch.quiet)
    print_message(fmt::format("{} settings on {} seeds in {}\n", plan.sweep.jobs.size() / kFirstSeeds, kFirstSeeds,
                              directory.string()));
  return run_race(program, directory, arguments.launch, {});
}

std::size_t check_tune(CommandEnvironment& program, const std::string& config) {
  const Tree composed = program.composer.compose(program.composer.found(config), {});
  const TuneDescription description(composed.find("tune"), {});
  const TunePlanner planner(program.composer, program.host, config, description);
  const auto ignore = [](const Job&, const ResolvedConfig&) {};
  return plan_first_round(planner, description.jobs.value_or(kJobsOfTime), "runs", ignore).sweep.jobs.size() /
         kFirstSeeds;
}

}  // namespace palpate::cli
