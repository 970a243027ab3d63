// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/gate.hpp"
#include "launch/estimate.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
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

/// "1000 jobs, about 1.2 s of computing with 2 at a time"
std::string size_words(const Program& program, const Campaign& campaign) {
  const std::size_t jobs = campaign.sweep.jobs.size();
  std::string words = fmt::format("{} job{}", jobs, jobs == 1 ? "" : "s");
  const std::optional<Estimate> estimate = estimate_job(program.host, campaign.config_of, jobs);
  if (!estimate) return words;
  const char* const about = estimate->at_least ? "at least" : "about";
  const double all = estimate->job_seconds * static_cast<double>(jobs);
  if (campaign.launch.launcher == kSlurm)
    return words + fmt::format(", {} {} of computing", about, duration_words(all));
  const std::size_t together = std::min(jobs, static_cast<std::size_t>(workers_of(campaign)));
  return words + fmt::format(", {} {} of computing with {} at a time", about,
                             duration_words(all / static_cast<double>(together)), together);
}

}  // namespace

int sweep(Program& program, const SweepArguments& arguments) {
  check_launch(arguments.launch);
  check_junit(arguments.launch.junit);
  bool one_at_a_time = false;
  std::optional<SweepDraft> draft;
  if (!arguments.list) draft.emplace(arguments.runs);
  const SweepPlan plan = plan_sweep(program.composer, program.host, arguments.config, arguments.axes, arguments.runs,
                                    [&](const Job& job, const ResolvedConfig& config) {
                                      if (draft) draft->add(job, config);
                                      one_at_a_time = one_at_a_time || program.host.one_at_a_time(config.notes.plugins);
                                    });
  const auto config_of = [&](std::size_t job) { return planned_config(plan, program.composer, program.host, job); };
  const Campaign campaign{plan.sweep, config_of, {}, arguments.launch, {}, one_at_a_time};
  if (arguments.list) {
    print_jobs(plan.sweep);
    if (!arguments.launch.quiet) mention(size_words(program, campaign) + "\n");
    return kDone;
  }
  const bool is_new = draft->publish(plan);
  draft.reset();
  if (!is_new) check_builds(program, campaign);
  if (!arguments.launch.quiet) {
    mention(fmt::format("{} in {}{}\n", size_words(program, campaign), plan.sweep.directory.string(),
                        is_new ? "" : ", which exists: what is missing is run"));
  }
  return run_campaign(program, campaign);
}

}  // namespace palpate::cli
