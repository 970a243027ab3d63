// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"

#include <memory>

namespace palpate::cli {

int resume(Program& program, const ResumeArguments& arguments) {
  const ResumeOptions options{arguments.retry_failed, arguments.force};
  if (is_sweep(arguments.directory)) {
    const Sweep sweep = read_sweep(arguments.directory);
    SweepLine line(arguments.quiet);
    const SweepReport report = run_sweep(program.workshop, sweep, nullptr, options, arguments.workers,
                                         [&](const SweepProgress& progress) { line.show(progress); });
    const ResolvedConfig first = load_run(program.host, sweep.directory / "jobs" / sweep.jobs.front().id);
    return print_sweep(sweep, report, static_cast<int>(first.options.initial.count));
  }
  std::unique_ptr<Journal> display;
  if (!arguments.quiet) display = std::make_unique<TapTable>(load_run(program.host, arguments.directory).options.taps);
  const RunReport report = resume_run(program.workshop, arguments.directory, options, display.get());
  if (!arguments.quiet) print_summary(report);
  return report.interrupted ? kInterrupted : kDone;
}

}  // namespace palpate::cli
