// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"

#include "cli/display.hpp"
#include "cli/gate.hpp"
#include "cli/interrupt.hpp"
#include "cli/sweep_display.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <map>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

namespace palpate::cli {
namespace {

/// Indices of those that are to run, as far as they are missing.
std::vector<std::size_t> jobs_of(const Campaign& campaign) {
  std::vector<std::size_t> jobs = campaign.only;
  if (jobs.empty()) {
    jobs.resize(campaign.sweep.jobs.size());
    std::iota(jobs.begin(), jobs.end(), std::size_t{0});
  }
  return jobs;
}

/// Whether no job of the sweep is missing: then its results are complete.
bool has_ended(const Sweep& sweep) {
  std::error_code none;
  return std::all_of(sweep.jobs.begin(), sweep.jobs.end(), [&](const Job& job) {
    return std::filesystem::exists(job_directory(sweep, job) / "summary.json", none);
  });
}

/// Some jobs of many, as a task of a cluster runs them: what is said of the whole is said elsewhere.
int conclude_part(const Sweep& sweep, const SweepReport& report) {
  if (has_ended(sweep)) write_results(sweep);
  print_failures(sweep, report.failures);
  if (report.interrupted) return kInterrupted;
  if (!report.failures.empty()) return kFailed;
  return report.unfinished > 0 ? kBusy : kDone;
}

/// The first config that can be read of the jobs of which `is_alike` holds; that of a damaged job cannot.
template <class IsAlike>
std::optional<ResolvedConfig> any_config(const Campaign& campaign, const IsAlike& is_alike) {
  for (const Job& job : campaign.sweep.jobs) {
    if (!is_alike(job)) continue;
    try {
      return campaign.config_of(static_cast<std::size_t>(job.index));
    } catch (const Error&) {  // the next will do
    }
  }
  return std::nullopt;
}

/// How many taps of a job are initial ones; none if no config tells. Jobs with the same strategy, design and budget
/// have as many: one config is read for all of them.
class InitialTaps {
 public:
  explicit InitialTaps(const Campaign& campaign) : campaign_(campaign) {
    const std::vector<std::string>& keys = campaign.sweep.keys;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::string first = keys[i].substr(0, keys[i].find('.'));
      if (first == "strategy" || first == "initial" || first == "taps") deciding_.push_back(i);
    }
  }

  std::optional<int> operator()(std::size_t job) {
    const Values values = values_of(campaign_.sweep.jobs[job]);
    const auto [known, is_new] = known_.try_emplace(values);
    if (!is_new) return known->second;
    const auto config = any_config(campaign_, [&](const Job& other) { return values_of(other) == values; });
    if (!config) return std::nullopt;
    const ExperimentOptions& options = config->options;
    // All taps until the first hit are the search's: its dead starts are those that never hit.
    known->second = static_cast<int>(options.initial.searches() ? options.taps : options.initial.count);
    return known->second;
  }

 private:
  using Values = std::vector<std::string>;

  Values values_of(const Job& job) const {
    Values values;
    for (const std::size_t i : deciding_) values.push_back(job.values[i]);
    return values;
  }

  const Campaign& campaign_;
  std::vector<std::size_t> deciding_;  ///< of the swept keys
  std::map<Values, std::optional<int>> known_;
};

int conclude_whole(const Campaign& campaign, const SweepReport& report) {
  const Sweep& sweep = campaign.sweep;
  const std::vector<std::optional<Row>> summaries = write_results(sweep);
  print_sweep(sweep, sweep_results(sweep, summaries), report, InitialTaps(campaign));
  if (report.interrupted) return kInterrupted;
  // What is expected stands in every job's config, and is judged of all.
  const auto config = any_config(campaign, [](const Job&) { return true; });
  if (!config) throw Error(sweep.directory.string(), "no job has a config.yaml that can be read", "put them back");
  const bool all_hold = conclude(config->expectations, outcomes_of(sweep, summaries),
                                 {config->options.name, campaign.launch.junit, true});
  return sweep_status(config->expectations, all_hold, !report.failures.empty() || report.unfinished > 0);
}

}  // namespace

void conduct_shown(const Program& program, const Campaign& campaign, Launcher& launcher, const Missing& missing) {
  SweepLine line(campaign.launch.quiet);
  conduct(launcher, campaign.sweep, missing, program.workshop.interrupted,
          [&](const SweepProgress& progress) { line.show(progress); });
}

int workers_of(const Campaign& campaign) {
  if (campaign.one_at_a_time) return 1;
  if (campaign.launch.launcher == kSlurm) return campaign.launch.workers.value_or(1);
  return campaign.launch.workers.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

void check_builds(const Program& program, Campaign& campaign, bool done_too) {
  for (const std::size_t job : jobs_of(campaign)) {
    const std::filesystem::path directory = job_directory(campaign.sweep, campaign.sweep.jobs[job]);
    if (!done_too && read_ending(directory).state == RunStatus::State::done) continue;
    bool elsewhere = false;
    try {
      const ResolvedConfig config = campaign.config_of(job);
      campaign.one_at_a_time = campaign.one_at_a_time || program.host.one_at_a_time(config.notes.plugins);
      elsewhere = is_of_another_build(program.workshop, config, directory);
    } catch (const Error&) {  // damaged: the job will say so, and costs itself alone
    }
    if (elsewhere && !campaign.options.force) check_build(program.workshop, campaign.config_of(job), directory);
  }
}

int run_campaign(Program& program, const Campaign& campaign) {
  const Sweep& sweep = campaign.sweep;
  const LaunchArguments& launch = campaign.launch;
  check_locks(sweep.directory);
  listen_for_interrupts();
  const bool whole = campaign.only.empty();
  const std::vector<std::size_t> jobs = jobs_of(campaign);
  const Missing missing = find_missing(sweep, jobs, campaign.options.retry_failed, launch.attempts);
  if (campaign.one_at_a_time && missing.jobs.size() > 1 && !launch.quiet) {
    mention("one job at a time: the backend has but one thing to move\n");
  }
  if (launch.launcher == kSlurm) {
    if (!missing.jobs.empty() && !run_on_slurm(program, campaign, missing)) return kDone;
  } else {
    LocalLauncher launcher(program.workshop, sweep, campaign.config_of,
                           {workers_of(campaign), campaign.options, launch.attempts, whole});
    conduct_shown(program, campaign, launcher, missing);
  }
  SweepReport report = report_on(sweep, jobs);
  report.interrupted = program.workshop.interrupted->load();
  return whole ? conclude_whole(campaign, report) : conclude_part(sweep, report);
}

}  // namespace palpate::cli
