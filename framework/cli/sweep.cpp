// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "cli/commands.hpp"
#include "cli/gate.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"

#include <fmt/format.h>

#include <numeric>
#include <optional>

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

}  // namespace

int sweep(Program& program, const SweepArguments& arguments) {
  if (arguments.list) {
    print_jobs(plan_sweep(program.composer, program.host, arguments.config, arguments.axes, arguments.runs).sweep);
    return kDone;
  }
  check_junit(arguments.launch.junit);
  std::optional<SweepDraft> draft(arguments.runs);
  const SweepPlan plan = plan_sweep(program.composer, program.host, arguments.config, arguments.axes, arguments.runs,
                                    [&](const Job& job, const ResolvedConfig& config) { draft->add(job, config); });
  const bool is_new = draft->publish(plan);
  draft.reset();

  const auto config_of = [&](std::size_t job) { return planned_config(plan, program.composer, program.host, job); };
  Campaign campaign{plan.sweep, config_of, {}, arguments.launch, {}};
  if (!is_new) check_builds(program, campaign);
  if (!arguments.launch.quiet) {
    fmt::print(stderr, "{} jobs in {}{}\n", plan.sweep.jobs.size(), plan.sweep.directory.string(),
               is_new ? "" : ", which exists: what is missing is run");
  }
  return run_campaign(program, campaign);
}

}  // namespace palpate::cli
