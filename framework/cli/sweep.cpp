// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/gate.hpp"
#include "launch/slurm_launcher.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

namespace palpate::cli {
namespace {

void print_jobs(const Sweep& sweep) {
  for (const Job& job : sweep.jobs) {
    fmt::print("{}  {}", job.index, job.id);
    for (std::size_t i = 0; i < job.values.size(); ++i) {
      if (!job.values[i].empty()) fmt::print("  {}={}", sweep.keys[i], job.values[i]);
    }
    fmt::print("\n");
  }
}

/// "1000 jobs". How long they take the line of progress says, once some have been measured.
std::string size_words(const Sweep& sweep) {
  return fmt::format("{} job{}", sweep.jobs.size(), sweep.jobs.size() == 1 ? "" : "s");
}

}  // namespace

std::size_t jobs_of_sweep(Program& program, const std::string& config) {
  return plan_sweep(program.composer, program.host, config, {}, "runs").sweep.jobs.size();
}

int sweep(Program& program, const SweepArguments& arguments) {
  check_launch(arguments.launch);
  check_sbatch_words(arguments.launch.sbatch);
  check_junit(arguments.launch.junit);
  bool one_at_a_time = false;
  std::optional<SweepDraft> draft;
  if (!arguments.list) draft.emplace(arguments.runs);
  const SweepPlan plan = plan_sweep(program.composer, program.host, arguments.config, arguments.axes, arguments.runs,
                                    [&](const Job& job, const ResolvedConfig& config) {
                                      if (draft) draft->add(job, config);
                                      one_at_a_time = one_at_a_time || program.host.one_at_a_time(config.notes.plugins);
                                    });
  const auto config_of = [&](std::size_t job) { return planned_config(plan, program.host, job); };
  Campaign campaign{plan.sweep, config_of, {}, arguments.launch, {}, one_at_a_time};
  if (arguments.list) {
    print_jobs(plan.sweep);
    if (!arguments.launch.quiet) mention(size_words(plan.sweep) + "\n");
    return kDone;
  }
  const bool is_new = draft->publish(plan);
  draft.reset();
  if (!is_new) check_builds(program, campaign, true);
  if (!arguments.launch.quiet) {
    mention(fmt::format("{} in {}{}\n", size_words(plan.sweep), plan.sweep.directory.string(),
                        is_new ? "" : ", which exists: what is missing is run"));
  }
  return run_campaign(program, campaign);
}

}  // namespace palpate::cli
