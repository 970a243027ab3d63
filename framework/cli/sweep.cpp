// SPDX-License-Identifier: MIT
#include "cli/sweep.hpp"

#include "analysis/compare_plan.hpp"
#include "analysis/sweep_table.hpp"
#include "cli/display.hpp"
#include "cli/gate.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/resume.hpp"
#include "cli/sweep_display.hpp"
#include "cli/sweep_execution.hpp"
#include "cli/tune.hpp"
#include "launch/job.hpp"
#include "record/files.hpp"
#include "record/run.hpp"
#include "report/words/words.hpp"
#include "scene/size_warnings.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"

#include <fmt/format.h>
#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include <charconv>
#include <optional>
#include <set>
#include <utility>

namespace palpate::cli {
namespace {

/// Prints the last messages of a process that ran only a part of the sweep, such as a task of a cluster. The process
/// that submitted the tasks prints the results of the whole sweep.
int finish_part(const Sweep& sweep, const JobStates& end, bool interrupted, bool all_recorded) {
  const bool complete = std::all_of(sweep.jobs.begin(), sweep.jobs.end(),
                                    [&](const Job& job) { return has_ended(job_directory(sweep, job)); });
  if (complete) write_results(sweep);
  print_failures(sweep, end.failures);
  if (interrupted) return kInterrupted;
  if (!end.failures.empty() || !all_recorded) return kFailed;
  return end.open.empty() ? kDone : kBusy;
}

/// Returns the maximum number of initial taps of a job; nullopt if the number depends on a camera's view. If the run
/// begins with a search or taps from any side, all its taps may be initial taps. `result`: the job's row of
/// results.csv.
std::optional<int> initial_taps_of(const ExperimentOptions& options, const Row& result) {
  if (!belief_option(options, "view").empty()) return std::nullopt;
  const bool any_side = result.find("no_contact_taps") != nullptr;
  return static_cast<int>(options.initial.searches() || any_side ? options.taps : options.initial.count);
}

int finish_whole(const SweepExecution& execution, const JobStates& end, bool interrupted, LaunchOutcome launched) {
  const Sweep& sweep = execution.sweep;
  const auto initial_taps = [&](std::size_t job, const Row& result) {
    const auto config = readable_config(execution, job);
    return config ? initial_taps_of(config->options, result) : std::nullopt;
  };
  print_text(sweep_table(sweep, write_results(sweep), initial_taps));
  print_failures(sweep, end.failures);
  const std::string directory = sweep.directory.string();
  if (!end.failures.empty()) print_out("try them again: palpate resume --retry-failed {}\n", directory);
  const bool open = interrupted || !end.open.empty() || launched == LaunchOutcome::ended_unrecorded;
  if (!open) set_record_line("record: " + directory);
  const bool blocked = launched == LaunchOutcome::blocked && !interrupted;
  print_out("{} {}\n",
            !open     ? "record:"
            : blocked ? "stopped for the reason above; correct it, then run: palpate resume"
                      : "resume with: palpate resume",
            directory);
  if (interrupted) return kInterrupted;
  // All jobs have the same expectations, so the first readable config is enough.
  std::optional<ResolvedConfig> config = execution.first;
  for (std::size_t job = 0; job < sweep.jobs.size() && !config; ++job) config = readable_config(execution, job);
  if (!config) throw Error(sweep.directory.string(), "no job has a readable config.yaml", "restore these files");
  const bool is_judged = !config->expectations.empty() || !execution.launch.junit.empty();
  const bool all_hold = !is_judged || conclude(config->expectations, outcomes_of(sweep),
                                               {config->options.name, execution.launch.junit, true});
  return open ? kFailed : sweep_status(config->expectations, all_hold, !end.failures.empty());
}

/// Runs the jobs that have not ended, prints the result and checks the expectations. Returns the exit status.
int execute_sweep(const SweepExecution& execution, JobStates begun) {
  const Sweep& sweep = execution.sweep;
  const bool whole = execution.only.empty();
  begin_execution(execution);
  const std::vector<std::size_t> jobs = jobs_not_done(begun);
  if (execution.options.retry_failed) reopen_failed(begun);
  const LaunchOutcome launched = launch_open(execution, begun);
  if (launched == LaunchOutcome::submitted) return kDone;
  // Missing files of ended jobs are not checked here. execute_jobs() has reported them, and this build may be unable to
  // restore the files of a job of another build.
  const JobStates end = read_job_states(sweep, jobs, JobCheck::nothing);
  const bool interrupted = execution.program.interrupted->load();
  if (whole) return finish_whole(execution, end, interrupted, launched);
  return finish_part(sweep, end, interrupted, launched != LaunchOutcome::ended_unrecorded);
}

/// Returns the numbers in a text such as "0-7,12" in ascending order, each once. Throws Error for a number that is too
/// large: it must be less than `count`.
std::vector<std::size_t> parse_jobs(const std::string& text, std::size_t count) {
  const auto refuse = [&] {
    return Error("command line", fmt::format("--jobs: '{}' is not a list of job numbers", text),
                 fmt::format("write for example 0-7,12, with numbers from 0 to {}", count - 1));
  };
  const auto number = [&](const std::string& word) {
    const char* const end = word.data() + word.size();
    std::size_t out = 0;
    const auto read = std::from_chars(word.data(), end, out);
    if (read.ec != std::errc() || read.ptr != end || out >= count) throw refuse();
    return out;
  };
  std::set<std::size_t> jobs;
  std::vector<std::string> parts;
  for (const std::string& part : boost::split(parts, text, boost::is_any_of(","))) {
    const auto dash = part.find('-');
    const std::size_t first = number(part.substr(0, dash));
    const std::size_t last = dash == std::string::npos ? first : number(part.substr(dash + 1));
    if (last < first) throw refuse();
    for (std::size_t job = first; job <= last; ++job) jobs.insert(job);
  }
  return {jobs.begin(), jobs.end()};
}

}  // namespace

std::size_t jobs_of_sweep(CommandEnvironment& program, const std::string& config) {
  const SweepPlan plan = plan_sweep(program.composer, program.host, config, {}, "runs");
  if (const auto planned = plan_in(plan.config)) planned->check(plan.sweep);
  return plan.sweep.jobs.size();
}

void check_compare(CommandEnvironment&, const Tree& config) { plan_in(config); }

int sweep(CommandEnvironment& program, const SweepArguments& arguments) {
  check_launch(arguments.launch);
  const LauncherType& launcher = checked_launcher(arguments.launch);
  // This check comes before the creation of the sweep, because a sweep that no scheduler can run must not be created.
  if (launcher.check_installed != nullptr && !arguments.list) launcher.check_installed();
  bool one_at_a_time = false;
  std::optional<ResolvedConfig> first;
  std::optional<SweepDraft> draft;
  if (!arguments.list) draft.emplace(arguments.runs);
  std::optional<SweepPlan> plan = plan_sweep(program.composer, program.host, arguments.config, arguments.axes,
                                             arguments.runs, [&](const Job& job, const ResolvedConfig& config) {
                                               if (draft) {
                                                 check_taps_are_own(config, "backend");
                                                 draft->add(job, config);
                                               }
                                               if (job.index == 0) first = config;
                                               one_at_a_time =
                                                   one_at_a_time || program.host.one_at_a_time(config.notes.plugins);
                                             });
  if (const auto planned = plan_in(plan->config)) planned->check(plan->sweep);
  const std::string jobs = counted(static_cast<long>(plan->sweep.jobs.size()), "job");
  if (arguments.list) {
    for (const Job& job : plan->sweep.jobs)
      print_out("{}  {}{}\n", job.index, job.id, values_text(plan->sweep, job, "  "));
    if (!arguments.launch.quiet) print_message(jobs + "\n");
    return kDone;
  }
  const bool is_new = draft->publish(*plan);
  const std::filesystem::path directory = plan->sweep.directory;
  draft.reset();
  plan.reset();  // Otherwise each child process would copy the memory of the plan.
  const Sweep planned = read_sweep(directory);
  SweepExecution execution{program, planned, {}, arguments.launch, {}, one_at_a_time, std::move(first)};
  if (!is_new) check_builds(execution, jobs_of(execution));
  if (!arguments.launch.quiet) {
    for (const std::string& line : partly_given_sizes(execution.first->tree, execution.first->notes))
      print_message(line + "\n");
    print_message(fmt::format("{} in {}{}\n", jobs, directory.string(),
                              is_new ? "" : ", which exists: only missing jobs are run"));
  }
  return execute_sweep(execution, read_job_states(planned, jobs_of(execution)));
}

int resume_sweep(CommandEnvironment& program, const ResumeArguments& arguments) {
  checked_launcher(arguments.launch);
  const auto refuse = [](const std::string& reason, const char* hint) { throw Error("command line", reason, hint); };
  if (arguments.step) refuse("--step: " + arguments.directory + " is a sweep of many runs", "leave it out");
  const Sweep sweep = read_sweep(arguments.directory);
  if (!sweep.rounds.empty() && arguments.jobs.empty())
    return run_race(program, arguments.directory, arguments.launch, arguments.options);
  SweepExecution execution{program, sweep, arguments.options, arguments.launch, {}, false};
  if (!arguments.jobs.empty()) {
    execution.only = parse_jobs(arguments.jobs, sweep.jobs.size());
    const char* const hint = "leave one of them out";
    if (arguments.launch.jobs_per_task.value_or(1) > 1)
      refuse("--jobs and --jobs-per-task exclude each other: a task runs all of its jobs", hint);
    if (!arguments.launch.junit.empty())
      refuse("--jobs and --junit exclude each other: expectations are checked for the whole sweep", hint);
  }
  JobStates begun = read_job_states(sweep, jobs_of(execution));
  const std::vector<std::size_t> left = jobs_not_done(begun);
  const std::optional<ResolvedConfig> next = left.empty() ? std::nullopt : readable_config(execution, left.front());
  if (next) check_taps_are_own(*next, arguments.directory);
  check_builds(execution, left);
  return execute_sweep(execution, std::move(begun));
}

/// Reads only the directories of the jobs. Calls neither the scheduler nor another process.
int status_of_sweep(CommandEnvironment&, const std::string& directory) {
  const Sweep sweep = read_sweep(directory);
  JobStates now = read_job_states(sweep, all_jobs(sweep), JobCheck::running);
  print_out("{} jobs", sweep.jobs.size());
  for (const auto state : {RunStatus::State::done, RunStatus::State::running, RunStatus::State::failed,
                           RunStatus::State::unfinished, RunStatus::State::absent}) {
    print_out(", {} {}", now.counts[state], state_name(state));
  }
  print_out("\n");
  print_failures(sweep, now.failures);
  return kDone;
}

}  // namespace palpate::cli
