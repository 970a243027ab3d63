// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/gate.hpp"

#include <fmt/format.h>

namespace palpate::cli {

int sweep(Program& program, const SweepArguments& arguments) {
  std::vector<Axis> axes;
  for (const std::string& text : arguments.axes) axes.push_back(parse_axis(text));
  const SweepPlan plan = plan_sweep(program.composer, program.host, arguments.config, axes, arguments.runs);
  if (arguments.list) {
    for (const Job& job : plan.sweep.jobs) {
      fmt::print("{}  {}", job.index, job.id);
      for (std::size_t i = 0; i < job.values.size(); ++i) fmt::print("  {}={}", plan.sweep.keys[i], job.values[i]);
      fmt::print("\n");
    }
    return kDone;
  }
  check_junit(arguments.junit);
  prepare_sweep(plan);
  if (!arguments.quiet) fmt::print(stderr, "{} jobs in {}\n", plan.sweep.jobs.size(), plan.sweep.directory.string());
  SweepLine line(arguments.quiet);
  const SweepReport report = run_sweep(program.workshop, plan.sweep, &plan.configs, {}, arguments.workers,
                                       [&](const SweepProgress& progress) { line.show(progress); });
  return conclude_sweep(plan.sweep, plan.configs.front(), report, arguments.junit);
}

int conclude_sweep(const Sweep& sweep, const ResolvedConfig& config, const SweepReport& report,
                   const std::string& junit) {
  print_sweep(sweep, report, static_cast<int>(config.options.initial.count));
  if (report.interrupted) return kInterrupted;
  const bool all_hold = conclude(config.expectations, outcomes_of(sweep), {config.options.name, junit, true});
  return sweep_status(config.expectations, all_hold, !report.failures.empty());
}

}  // namespace palpate::cli
