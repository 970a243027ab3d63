// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/gate.hpp"

#include <memory>

namespace palpate::cli {

int resume(Program& program, const ResumeArguments& arguments) {
  check_junit(arguments.junit);
  const ResumeOptions options{arguments.retry_failed, arguments.force};
  if (is_sweep(arguments.directory)) {
    const Sweep sweep = read_sweep(arguments.directory);
    SweepLine line(arguments.quiet);
    const SweepReport report = run_sweep(program.workshop, sweep, nullptr, options, arguments.workers,
                                         [&](const SweepProgress& progress) { line.show(progress); });
    return conclude_sweep(sweep, load_run(program.host, job_directory(sweep, sweep.jobs.front())), report,
                          arguments.junit);
  }
  const ResolvedConfig config = load_run(program.host, arguments.directory);
  std::unique_ptr<Journal> display;
  if (!arguments.quiet) display = std::make_unique<TapTable>(config.options.taps);
  return conclude_run(config, {!arguments.quiet, false, arguments.junit},
                      [&] { return resume_run(program.workshop, arguments.directory, options, display.get()); });
}

}  // namespace palpate::cli
