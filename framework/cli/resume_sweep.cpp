// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "cli/commands.hpp"
#include "launch/slurm_launcher.hpp"

#include <palpate/error.hpp>

namespace palpate::cli {
namespace {

/// Every job that will run is checked before the first does: it may have been begun by another build.
void check_jobs(const Program& program, Campaign& campaign) {
  const std::vector<std::size_t>& only = campaign.only;
  for (std::size_t i = 0; i < (only.empty() ? campaign.sweep.jobs.size() : only.size()); ++i) {
    const std::size_t job = only.empty() ? i : only[i];
    const std::filesystem::path directory = job_directory(campaign.sweep, campaign.sweep.jobs[job]);
    if (read_ending(directory).state == RunStatus::State::done) continue;
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

}  // namespace

int resume_sweep(Program& program, const ResumeArguments& arguments) {
  check_sbatch_words(arguments.launch.sbatch);
  const ResumeOptions options{arguments.retry_failed, arguments.force};
  if (arguments.step) {
    throw Error("command line", "--step: " + arguments.directory + " is a sweep of many runs", "leave it out");
  }
  const Sweep sweep = read_sweep(arguments.directory);
  const auto config_of = [&](std::size_t job) { return load_run(program.host, job_directory(sweep, sweep.jobs[job])); };
  Campaign campaign{sweep, config_of, options, arguments.launch, {}, false};
  if (!arguments.jobs.empty()) campaign.only = parse_jobs(arguments.jobs, sweep.jobs.size());
  if (!arguments.jobs.empty() && arguments.launch.jobs_per_task.value_or(1) > 1) {
    throw Error("command line", "--jobs and --jobs-per-task do not go together: a task carries on all of its jobs",
                "leave one of them out");
  }
  if (!arguments.jobs.empty() && !arguments.launch.junit.empty()) {
    throw Error("command line", "--jobs and --junit do not go together: what is expected is judged of the whole sweep",
                "leave one of them out");
  }
  check_jobs(program, campaign);
  return run_campaign(program, campaign);
}

}  // namespace palpate::cli
